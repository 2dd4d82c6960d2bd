//! Symmetric positive definite band matrices: Cholesky without pivots, rows of a fixed width.

/// The lower band of a symmetric matrix: `rows[i][j]` is element (i, i − j) for `j` below `WIDTH`.
pub(super) struct Banded<const WIDTH: usize> {
    rows: Vec<[f64; WIDTH]>,
}

impl<const WIDTH: usize> Banded<WIDTH> {
    /// Makes a matrix of zeros.
    pub(super) fn zeros(n: usize) -> Self {
        Self { rows: vec![[0.0; WIDTH]; n] }
    }

    /// Adds to element (row, column); `column` is at most `row`, and less than `WIDTH` before it.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row][row - column] += value;
    }

    /// Solves for the right-hand side in place. The matrix must be positive definite.
    pub(super) fn solve(mut self, rhs: &mut [f64]) {
        let n = self.rows.len();
        for i in 0..n {
            let mut row = self.rows[i];
            let first = (WIDTH - 1).min(i);
            // Columns from left to right; row[j] is column i − j.
            for j in (1..=first).rev() {
                let other = &self.rows[i - j];
                let mut sum = row[j];
                for k in j + 1..=first {
                    sum -= row[k] * other[k - j];
                }
                row[j] = sum * other[0];
            }
            let mut diagonal = row[0];
            for value in &row[1..=first] {
                diagonal -= value * value;
            }
            // The diagonal is kept inverted.
            row[0] = 1.0 / diagonal.max(f64::MIN_POSITIVE).sqrt();
            let mut sum = rhs[i];
            for j in 1..=first {
                sum -= row[j] * rhs[i - j];
            }
            rhs[i] = sum * row[0];
            self.rows[i] = row;
        }
        for i in (0..n).rev() {
            let row = &self.rows[i];
            rhs[i] *= row[0];
            for j in 1..=(WIDTH - 1).min(i) {
                rhs[i - j] -= row[j] * rhs[i];
            }
        }
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
        let mut rhs: Vec<f64> =
            (0..N).map(|row| (0..N).map(|column| element(row, column) * solution[column]).sum()).collect();
        matrix.solve(&mut rhs);
        for (found, expected) in rhs.iter().zip(&solution) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
