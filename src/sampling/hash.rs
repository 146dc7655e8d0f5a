//! Numbers from bits, and bits from names: what makes points pure functions of (seed, cell, replicate, index, coordinate).

/// SplitMix64's increment, 2⁶⁴ divided by the golden ratio.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// SplitMix64's mixer: a bijection of 64-bit words (Steele, Lea, Flood, *Fast splittable pseudorandom number generators*, 2014, §3).
#[inline]
pub(crate) fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The key of one randomisation.
#[inline]
pub(crate) fn key(seed: u64, cell: u64, replicate: u32) -> u64 {
    mix(mix(mix(seed.wrapping_add(GOLDEN)) ^ cell).wrapping_add(GOLDEN) ^ u64::from(replicate))
}

/// Word number `n` of the stream with key `key`.
#[inline]
pub(crate) fn word(key: u64, n: u64) -> u64 {
    mix(key.wrapping_add(n.wrapping_add(1).wrapping_mul(GOLDEN)))
}

/// Word number `n` of the stream with a key that is itself a hash, by one wide multiplication (Wang Yi, wyrand, 2019): half the price of
/// [`word`].
#[inline]
pub(crate) fn folded(key: u64, n: u64) -> u64 {
    let x = key.wrapping_add(n.wrapping_add(1).wrapping_mul(GOLDEN));
    let product = u128::from(x) * u128::from(x ^ 0xa076_1d64_78bd_642f);
    (product >> 64) as u64 ^ product as u64
}

/// ⌊`fraction` n⌋ for a fraction of 2⁶⁴: a number below n.
#[inline]
pub(crate) fn below(fraction: u64, n: u64) -> u64 {
    ((u128::from(fraction) * u128::from(n)) >> 64) as u64
}

/// (k + ½) 2⁻⁵² from the top 52 bits: exact, and never 0 or 1 (theory (6.1.4)).
#[inline]
pub(crate) fn open_unit(bits: u64) -> f64 {
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    // [1, 2) − (1 − 2⁻⁵³): both the operand and the result are representable, so nothing rounds
    f64::from_bits((bits >> 12) | ONE) - (1.0 - f64::EPSILON / 2.0)
}

/// The midpoint (k + ½) 2⁻⁵² of the cell of width 2⁻⁵² that holds x ∈ [0, 1]: strictly inside, like every number of the crate. An x that
/// was rounded up to 1 belongs to the last cell.
#[inline]
pub(crate) fn midpoint(x: f64) -> f64 {
    const CELLS: f64 = (1u64 << 52) as f64;
    // a cast, not `floor`, which is a function call where the processor's oldest instructions must do
    ((x * CELLS).min(CELLS - 1.0) as i64 as f64 + 0.5) / CELLS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniforms_stay_strictly_inside_the_unit_interval() {
        assert_eq!(open_unit(0), 2f64.powi(-53));
        assert_eq!(open_unit(u64::MAX), 1.0 - 2f64.powi(-53));
        assert_eq!(open_unit(1 << 63), 0.5 + 2f64.powi(-53));
        assert_eq!((midpoint(0.0), midpoint(1.0)), (2f64.powi(-53), 1.0 - 2f64.powi(-53)));
        assert_eq!(midpoint(0.5), 0.5 + 2f64.powi(-53));
    }
}
