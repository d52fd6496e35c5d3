//! Sums and extremes whose bits do not depend on the number of threads: fixed chunks, combined in order.

use rayon::prelude::*;
use std::ops::{Add, Range};

/// Rows per chunk of a reduction. Part of the result's definition: changing it changes the last bits.
const CHUNK: usize = 2048;

/// `sum of term(i)` for `i` in `0..count`, in chunks of fixed size added in order.
pub fn ordered_sum<T>(count: usize, zero: T, term: impl Fn(usize) -> T + Sync) -> T
where
    T: Add<Output = T> + Copy + Send + Sync,
{
    ordered_fold(count, zero, |acc, i| acc + term(i), |a, b| a + b)
}

/// Largest `value(i)`, or `floor` if that is larger or there are no rows.
pub fn ordered_max(count: usize, floor: f64, value: impl Fn(usize) -> f64 + Sync) -> f64 {
    ordered_fold(count, floor, |acc: f64, i| acc.max(value(i)), f64::max)
}

/// Folds rows in chunks of fixed size and joins the chunks in order.
pub fn ordered_fold<T>(count: usize, zero: T, step: impl Fn(T, usize) -> T + Sync, join: impl Fn(T, T) -> T) -> T
where
    T: Copy + Send + Sync,
{
    let chunk = |range: Range<usize>| range.fold(zero, &step);
    if count <= CHUNK {
        return chunk(0..count);
    }
    let chunks: Vec<T> =
        (0..count.div_ceil(CHUNK)).into_par_iter().map(|c| chunk(c * CHUNK..((c + 1) * CHUNK).min(count))).collect();
    chunks.into_iter().fold(zero, join)
}
