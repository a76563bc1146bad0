//! Ribs along a stem, as columnar cacti have them.

use super::expr::Expr;
use super::figure::Kind;

pub(super) const RIBS: Kind = Kind { name: "ribs", least: 1.0, height: -0.5, mean: 0.375, follows_limbs: true, share };

/// Twelve furrows around: `cos 12 a` of the angle around the stem, by two triplings of its cosine and sine.
fn share() -> Expr {
    let across = Expr::from(1e-6).max((Expr::X * Expr::X + Expr::Z * Expr::Z).sqrt());
    // cos 3a = 4 c^3 - 3 c; cos 6a = 2 (cos 3a)^2 - 1; cos 12a likewise.
    let c = Expr::X / across;
    let three = c.clone() * c.clone() * c.clone() * 4.0 - c * 3.0;
    let double = |x: Expr| x.clone() * x * 2.0 - 1.0;
    let twelve = double(double(three));
    let furrow = Expr::from(0.5) - twelve * 0.5;
    furrow.clone() * furrow
}
