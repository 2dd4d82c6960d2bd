//! Symmetric positive definite band matrices: Cholesky without pivots, columns of a fixed height.

/// The lower band of a symmetric matrix: `columns[j][d]` is element (j + d, j) for `d` below `WIDTH`.
pub(super) struct Banded<const WIDTH: usize> {
    columns: Vec<[f64; WIDTH]>,
}

impl<const WIDTH: usize> Banded<WIDTH> {
    /// Makes a matrix of zeros.
    pub(super) fn zeros(n: usize) -> Self {
        // What is beyond the last column is there for every column to have as many after it.
        Self { columns: vec![[0.0; WIDTH]; n + WIDTH] }
    }

    /// Adds to element (row, column); `column` is at most `row`, and less than `WIDTH` before it.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.columns[column][row - column] += value;
    }

    /// Solves for the right-hand side. The matrix must be positive definite.
    ///
    /// Each column is taken off those after it as soon as it is known: sums that do not wait for one another.
    pub(super) fn solve(mut self, mut rhs: Vec<f64>) -> Vec<f64> {
        let n = rhs.len();
        rhs.resize(n + WIDTH, 0.0);
        for j in 0..n {
            let [column, after @ ..] = &mut self.columns[j..j + WIDTH] else {
                unreachable!("a column and those after it")
            };
            // The diagonal is kept inverted.
            let inverse = 1.0 / column[0].max(f64::MIN_POSITIVE).sqrt();
            column.iter_mut().for_each(|value| *value *= inverse);
            column[0] = inverse;
            let mut below = [[0.0; WIDTH]; 2];
            below[0] = *column;
            let below = below.as_flattened();
            for (d, after) in (1..).zip(after) {
                let share = column[d];
                after.iter_mut().zip(&below[d..d + WIDTH]).for_each(|(value, below)| *value -= share * below);
            }
            let known = rhs[j] * inverse;
            rhs[j] = known;
            rhs[j + 1..j + WIDTH].iter_mut().zip(&column[1..]).for_each(|(value, below)| *value -= known * below);
        }
        for j in (0..n).rev() {
            let [inverse, below @ ..] = &self.columns[j][..] else { unreachable!("a column has a diagonal") };
            let known = below.iter().zip(&rhs[j + 1..]).fold(rhs[j], |rest, (below, x)| rest - below * x);
            rhs[j] = known * inverse;
        }
        rhs.truncate(n);
        rhs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_system_is_solved() {
        const N: usize = 23;
        let element = |row: usize, column: usize| match row.abs_diff(column) {
            0 => 9.0 + row as f64,
            d @ 1..4 => ((row * column) as f64).sin() / d as f64,
            _ => 0.0,
        };
        let mut matrix = Banded::<4>::zeros(N);
        for row in 0..N {
            for column in row.saturating_sub(3)..=row {
                matrix.add(row, column, element(row, column));
            }
        }
        let solution: Vec<f64> = (0..N).map(|i| (i as f64).cos()).collect();
        let rhs: Vec<f64> =
            (0..N).map(|row| (0..N).map(|column| element(row, column) * solution[column]).sum()).collect();
        for (found, expected) in matrix.solve(rhs).iter().zip(&solution) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
