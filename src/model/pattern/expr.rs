//! Expressions of a place: evaluated here, printed in the language of a renderer.

use std::fmt;
use std::ops::{Add, Div, Mul, Sub};

use crate::math::DVec3;

/// An expression of the coordinates of a place.
#[derive(Clone, Debug, PartialEq)]
pub enum Expr {
    /// The first coordinate.
    X,
    /// The second coordinate.
    Y,
    /// The third coordinate.
    Z,
    /// A constant.
    Number(f64),
    /// A function of one value.
    Call(Function, Box<Expr>),
    /// An operation on two values.
    Pair(Operation, Box<Expr>, Box<Expr>),
}

/// A function of one value; POV-Ray and the RenderMan Shading Language call it alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Function {
    /// Sine, of radians.
    Sin,
    /// Absolute value.
    Abs,
    /// Square root.
    Sqrt,
}

/// An operation on two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    /// Sum.
    Add,
    /// Difference.
    Sub,
    /// Product.
    Mul,
    /// Quotient.
    Div,
    /// The lesser.
    Min,
    /// The greater.
    Max,
}

impl Expr {
    /// Its value at `p`.
    #[must_use]
    pub fn at(&self, p: DVec3) -> f64 {
        match self {
            Self::X => p.x,
            Self::Y => p.y,
            Self::Z => p.z,
            Self::Number(x) => *x,
            Self::Call(function, x) => match function {
                Function::Sin => libm::sin(x.at(p)),
                Function::Abs => x.at(p).abs(),
                Function::Sqrt => libm::sqrt(x.at(p)),
            },
            Self::Pair(operation, a, b) => {
                let (a, b) = (a.at(p), b.at(p));
                match operation {
                    Operation::Add => a + b,
                    Operation::Sub => a - b,
                    Operation::Mul => a * b,
                    Operation::Div => a / b,
                    Operation::Min => a.min(b),
                    Operation::Max => a.max(b),
                }
            }
        }
    }

    /// Its sine.
    #[must_use]
    pub fn sin(self) -> Self {
        Self::Call(Function::Sin, Box::new(self))
    }

    /// Its absolute value.
    #[must_use]
    pub fn abs(self) -> Self {
        Self::Call(Function::Abs, Box::new(self))
    }

    /// Its square root.
    #[must_use]
    pub fn sqrt(self) -> Self {
        Self::Call(Function::Sqrt, Box::new(self))
    }

    /// The lesser of both.
    #[must_use]
    pub fn min(self, other: impl Into<Self>) -> Self {
        Self::pair(Operation::Min, self, other.into())
    }

    /// The greater of both.
    #[must_use]
    pub fn max(self, other: impl Into<Self>) -> Self {
        Self::pair(Operation::Max, self, other.into())
    }

    /// It, or 0 or 1 where it is less or more.
    #[must_use]
    pub fn share(self) -> Self {
        Self::from(1.0).min(Self::from(0.0).max(self))
    }

    fn pair(operation: Operation, a: Self, b: Self) -> Self {
        Self::Pair(operation, Box::new(a), Box::new(b))
    }

    /// Is it a sum or a difference, which binds less than a product?
    fn is_sum(&self) -> bool {
        matches!(self, Self::Pair(Operation::Add | Operation::Sub, ..))
    }

    /// Does its text begin with a minus?
    fn is_negative(&self) -> bool {
        match self {
            Self::Number(x) => x.is_sign_negative(),
            Self::Pair(Operation::Add | Operation::Sub, a, _) => a.is_negative(),
            // A sum in a product stands in parentheses.
            Self::Pair(Operation::Mul | Operation::Div, a, _) => !a.is_sum() && a.is_negative(),
            _ => false,
        }
    }
}

impl From<f64> for Expr {
    fn from(x: f64) -> Self {
        Self::Number(x)
    }
}

impl<T: Into<Expr>> Add<T> for Expr {
    type Output = Self;

    fn add(self, other: T) -> Self {
        Self::pair(Operation::Add, self, other.into())
    }
}

impl<T: Into<Expr>> Sub<T> for Expr {
    type Output = Self;

    fn sub(self, other: T) -> Self {
        Self::pair(Operation::Sub, self, other.into())
    }
}

impl<T: Into<Expr>> Mul<T> for Expr {
    type Output = Self;

    fn mul(self, other: T) -> Self {
        Self::pair(Operation::Mul, self, other.into())
    }
}

impl<T: Into<Expr>> Div<T> for Expr {
    type Output = Self;

    fn div(self, other: T) -> Self {
        Self::pair(Operation::Div, self, other.into())
    }
}

/// Its text, which POV-Ray and the RenderMan Shading Language both read; coordinates are `x`, `y` and `z`.
impl fmt::Display for Expr {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::X => write!(f, "x"),
            Self::Y => write!(f, "y"),
            Self::Z => write!(f, "z"),
            Self::Number(x) => write!(f, "{x}"),
            Self::Call(Function::Sin, x) => write!(f, "sin({x})"),
            Self::Call(Function::Abs, x) => write!(f, "abs({x})"),
            Self::Call(Function::Sqrt, x) => write!(f, "sqrt({x})"),
            Self::Pair(Operation::Min, a, b) => write!(f, "min({a},{b})"),
            Self::Pair(Operation::Max, a, b) => write!(f, "max({a},{b})"),
            // A minus of its own takes the place of the plus.
            Self::Pair(Operation::Add, a, b) if b.is_negative() => write!(f, "{a}{b}"),
            Self::Pair(Operation::Add, a, b) => write!(f, "{a}+{b}"),
            Self::Pair(Operation::Sub, a, b) if b.is_sum() || b.is_negative() => write!(f, "{a}-({b})"),
            Self::Pair(Operation::Sub, a, b) => write!(f, "{a}-{b}"),
            Self::Pair(operation @ (Operation::Mul | Operation::Div), a, b) => {
                let sign = if *operation == Operation::Mul { '*' } else { '/' };
                let is_inner = |e: &Self| matches!(e, Self::Pair(Operation::Mul | Operation::Div, ..));
                if a.is_sum() { write!(f, "({a}){sign}") } else { write!(f, "{a}{sign}") }?;
                if b.is_sum() || b.is_negative() || is_inner(b) { write!(f, "({b})") } else { write!(f, "{b}") }
            }
        }
    }
}

/// `sin(along . p + phase + bend sin(by . p))`: patterns are made of sums of these.
pub(super) struct Wave {
    /// Its wave vector: upper side, along the limb, across.
    pub along: [f64; 3],
    /// Its phase.
    pub phase: f64,
    /// How far another wave bends it.
    pub bend: f64,
    /// That other wave's vector.
    pub by: [f64; 3],
}

/// The sum of `waves`.
pub(super) fn waves(waves: &[Wave]) -> Expr {
    let dot = |[a, b, c]: [f64; 3]| Expr::from(a) * Expr::X + Expr::from(b) * Expr::Y + Expr::from(c) * Expr::Z;
    let wave = |w: &Wave| (dot(w.along) + w.phase + Expr::from(w.bend) * dot(w.by).sin()).sin();
    waves.iter().map(wave).reduce(|sum, wave| sum + wave).unwrap_or(Expr::Number(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_mean_what_is_evaluated() {
        let p = DVec3::new(2.0, 3.0, 5.0);
        let number = |x: f64| Expr::from(x);
        for (expr, text, value) in [
            ((Expr::X + Expr::Y) * Expr::Z, "(x+y)*z", 25.0),
            (Expr::X - (Expr::Y - Expr::Z), "x-(y-z)", 4.0),
            (Expr::X / (Expr::Y * Expr::Z), "x/(y*z)", 2.0 / 15.0),
            (Expr::X / Expr::Y * Expr::Z, "x/y*z", 2.0 / 3.0 * 5.0),
            (Expr::X + number(-2.0) * Expr::Y, "x-2*y", -4.0),
            (Expr::X - number(-2.0), "x-(-2)", 4.0),
            (Expr::X + (number(-2.0) + Expr::X) * Expr::Y, "x+(-2+x)*y", 2.0),
            (number(1.0).min(Expr::X).max(0.5), "max(min(1,x),0.5)", 1.0),
            ((Expr::X * Expr::X + Expr::Z).sqrt().abs(), "abs(sqrt(x*x+z))", 3.0),
        ] {
            assert_eq!(expr.to_string(), text);
            assert!((expr.at(p) - value).abs() < 1e-15, "{text}: {}", expr.at(p));
        }
    }
}
