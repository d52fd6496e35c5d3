//! Frequency and damping of a sampled oscillation.
//!
//! # Equation
//! `x(t) = C + exp(-gamma t) (A cos omega t + B sin omega t)`
//!
//! # Discretisation
//! Gauss-Newton on all five parameters from the best undamped sinusoid within 40 % of a guess; steps that make the sum
//! of squares worse are halved. The samples need not be even in time.

/// A fitted oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// Angular frequency `omega`, rad/s.
    pub frequency: f64,
    /// Damping rate `gamma`, 1/s; negative where the oscillation grows.
    pub damping: f64,
    /// Amplitude at time 0, in units of the samples.
    pub amplitude: f64,
    /// Root mean square of what the fit leaves, relative to the amplitude.
    pub residual: f64,
}

/// Parameters `C, A, B, gamma, omega`, with time in units of the inverse guess.
type Parameters = [f64; 5];

const ITERATIONS: usize = 60;
const SCAN: u32 = 81;

impl Oscillation {
    /// Fits samples `(time, value)`; `guess` is an angular frequency within 40 % of the true one, rad/s.
    #[must_use]
    pub fn fit(samples: &[(f64, f64)], guess: f64) -> Self {
        let scaled: Vec<(f64, f64)> = samples.iter().map(|(t, x)| (t * guess, *x)).collect();
        let mut best = undamped(&scaled);
        for _ in 0..ITERATIONS {
            let Some(next) = improved(&scaled, best) else { break };
            best = next;
        }
        let [_, a, b, damping, frequency] = best;
        let amplitude = a.hypot(b);
        let residual = (squares(&scaled, best) / scaled.len() as f64).sqrt() / amplitude;
        Self { frequency: frequency * guess, damping: damping * guess, amplitude, residual }
    }
}

/// The best undamped sinusoid of those tried.
fn undamped(samples: &[(f64, f64)]) -> Parameters {
    let at = |k: u32| {
        let omega = 0.6 + 0.8 * f64::from(k) / f64::from(SCAN - 1);
        let basis = |t: f64| [1.0, (omega * t).cos(), (omega * t).sin()];
        let [c, a, b] = least_squares(samples.iter().map(|(t, x)| (basis(*t), *x)));
        [c, a, b, 0.0, omega]
    };
    let better = |p: Parameters, q: Parameters| if squares(samples, q) < squares(samples, p) { q } else { p };
    (0..SCAN).map(at).reduce(better).expect("invariant: several frequencies are tried")
}

/// One Gauss-Newton step, shortened until it helps; `None` if none does.
fn improved(samples: &[(f64, f64)], p: Parameters) -> Option<Parameters> {
    let row = |t: f64| {
        let (sin, cos) = (p[4] * t).sin_cos();
        let decay = (-p[3] * t).exp();
        let swing = p[1] * cos + p[2] * sin;
        [1.0, decay * cos, decay * sin, -t * decay * swing, t * decay * (p[2] * cos - p[1] * sin)]
    };
    let step = least_squares(samples.iter().map(|(t, x)| (row(*t), x - value(p, *t))));
    let before = squares(samples, p);
    let shortened = (0..20).map(|k| 0.5_f64.powi(k));
    let mut tried = shortened.map(|share| std::array::from_fn(|i| p[i] + share * step[i]));
    tried.find(|q| squares(samples, *q) < before * (1.0 - 1e-14))
}

fn value(p: Parameters, t: f64) -> f64 {
    let (sin, cos) = (p[4] * t).sin_cos();
    p[0] + (-p[3] * t).exp() * (p[1] * cos + p[2] * sin)
}

fn squares(samples: &[(f64, f64)], p: Parameters) -> f64 {
    samples.iter().map(|(t, x)| (x - value(p, *t)).powi(2)).sum()
}

/// Coefficients of the rows that fit the values best; NaN where the rows do not determine them.
pub(super) fn least_squares<const N: usize>(rows: impl Iterator<Item = ([f64; N], f64)>) -> [f64; N] {
    let mut matrix = [[0.0; N]; N];
    let mut rhs = [0.0; N];
    for (row, value) in rows {
        for i in 0..N {
            rhs[i] += row[i] * value;
            for j in 0..N {
                matrix[i][j] += row[i] * row[j];
            }
        }
    }
    eliminate(matrix, rhs)
}

/// Gauss elimination with pivots.
fn eliminate<const N: usize>(mut m: [[f64; N]; N], mut x: [f64; N]) -> [f64; N] {
    for i in 0..N {
        let pivot = (i..N).max_by(|&a, &b| m[a][i].abs().total_cmp(&m[b][i].abs())).unwrap_or(i);
        m.swap(i, pivot);
        x.swap(i, pivot);
        for k in i + 1..N {
            let factor = m[k][i] / m[i][i];
            let upper = m[i];
            m[k].iter_mut().zip(upper).skip(i).for_each(|(lower, upper)| *lower -= factor * upper);
            x[k] -= factor * x[i];
        }
    }
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|j| m[i][j] * x[j]).sum();
        x[i] = (x[i] - known) / m[i][i];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_damped_oscillation_about_an_offset_is_recovered() {
        let sample = |k: u32| {
            let t = 0.013 * f64::from(k) + 0.001 * f64::from(k % 3);
            (t, 0.2 + (-0.4 * t).exp() * (11.0 * t - 0.7).cos())
        };
        let samples: Vec<(f64, f64)> = (0..60).map(sample).collect();
        let fit = Oscillation::fit(&samples, 9.0);
        assert!((fit.frequency - 11.0).abs() < 1e-8, "{fit:?}");
        assert!((fit.damping - 0.4).abs() < 1e-8 && (fit.amplitude - 1.0).abs() < 1e-8 && fit.residual < 1e-8);
    }
}
