//! Counter-based random numbers: a pure function of (seed, stable id, step, use), so that no order of evaluation and
//! no number of threads can change them.

/// What a random number is used for; keeps the streams apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u64)]
pub enum Use {
    /// Seeds of noise fields that the scene does not seed itself.
    NoiseSeed = 1,
    /// Which bubble bursts next.
    Burst = 2,
}

/// 64 random bits for particle `id` at `step`.
#[must_use]
pub fn bits(seed: u64, id: u64, step: u64, purpose: Use) -> u64 {
    [id, step, purpose as u64].iter().fold(mix(seed), |state, word| mix(state ^ mix(*word)))
}

/// The finaliser of splitmix64 (Steele, Lea and Flood 2014).
const fn mix(v: u64) -> u64 {
    let v = v.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let v = (v ^ (v >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let v = (v ^ (v >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    v ^ (v >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_balanced_and_depend_on_every_key() {
        let ones: u32 = (0..4096).map(|id| bits(1, id, 0, Use::NoiseSeed).count_ones()).sum();
        assert!((f64::from(ones) / 4096.0 - 32.0).abs() < 0.3);
        let base = bits(1, 2, 3, Use::NoiseSeed);
        assert!(
            [bits(2, 2, 3, Use::NoiseSeed), bits(1, 3, 3, Use::NoiseSeed), bits(1, 2, 4, Use::NoiseSeed)]
                .iter()
                .all(|other| *other != base)
        );
    }
}
