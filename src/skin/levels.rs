//! Levels of growth as objects of their own.

use std::collections::HashMap;

use crate::model::{Body, Limbs, Object};

/// `object` as one for each level of growth, each with the same foot; alone where it has only one level. Limbs that go on
/// from another level start with a ball of it.
#[must_use]
pub fn by_level(object: Object) -> Vec<Object> {
    let Body::Limbs(limbs) = &object.body else { return vec![object] };
    let mut levels: Vec<u16> = limbs.balls.iter().map(|ball| ball.level).collect();
    levels.sort_unstable();
    levels.dedup();
    if levels.len() < 2 {
        return vec![object];
    }
    let of = |level: u16| Object {
        name: format!("{}_level_{level}", object.name),
        instances: object.instances.clone(),
        body: Body::Limbs(of_level(limbs, level)),
        ..object
    };
    levels.into_iter().map(of).collect()
}

/// The limbs of one level.
fn of_level(limbs: &Limbs, level: u16) -> Limbs {
    let mut renamed: HashMap<u32, u32> = HashMap::new();
    let mut own = Limbs { thorns: limbs.thorns, is_thorns: limbs.is_thorns, ..Limbs::default() };
    let mut put = |own: &mut Limbs, i: u32| {
        *renamed.entry(i).or_insert_with(|| {
            own.balls.push(limbs.balls[i as usize]);
            own.beyond.extend(limbs.beyond.get(i as usize));
            own.balls.len() as u32 - 1
        })
    };
    for &[a, b] in limbs.segments.iter().filter(|[_, b]| limbs.balls[*b as usize].level == level) {
        let segment = [put(&mut own, a), put(&mut own, b)];
        own.segments.push(segment);
    }
    // Balls that no segment shows are shown alone.
    for (i, _) in (0..).zip(&limbs.balls).filter(|(_, ball)| ball.level == level) {
        put(&mut own, i);
    }
    own
}
