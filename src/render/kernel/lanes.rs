//! Vectors of 16 pixels: loads, stores and sums, and the members of sets of blocks.

use fearless_simd::{f32x8, f32x16, prelude::*};

use super::super::grid::{BlockSet, Lanes};

#[inline(always)]
pub(in crate::render) fn load<S: Simd>(simd: S, lanes: &Lanes) -> f32x16<S> {
    f32x16::load_array_ref(simd, &lanes.0)
}

#[inline(always)]
pub(in crate::render) fn store<S: Simd>(value: f32x16<S>, lanes: &mut Lanes) {
    value.store_slice(&mut lanes.0);
}

/// The sum of all lanes, in one order at every SIMD level.
#[inline(always)]
pub(in crate::render) fn total<S: Simd>(v: f32x16<S>) -> f32 {
    let (low, high) = v.split();
    let eight: f32x8<S> = low + high;
    let (low, high) = eight.split();
    let four = low + high;
    (four[0] + four[2]) + (four[1] + four[3])
}

/// The members of a set, in rising order.
#[inline(always)]
pub(in crate::render) fn members(mut set: BlockSet) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (set != 0).then(|| {
            let block = set.trailing_zeros() as usize;
            set &= set - 1;
            block
        })
    })
}
