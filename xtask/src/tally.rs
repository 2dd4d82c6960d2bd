//! Counts what `cargo test` reports.

/// Tests that passed and failed, summed over test programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    /// Tests that passed.
    pub(crate) passed: u64,
    /// Tests that failed.
    pub(crate) failed: u64,
}

impl Tally {
    /// Adds a line of a test program's output; lines that are no result change nothing.
    pub(crate) fn read(&mut self, line: &str) {
        let Some(result) = line.strip_prefix("test result: ") else { return };
        self.passed += count(result, " passed;");
        self.failed += count(result, " failed;");
    }
}

/// Returns the number before a word of a result line, 0 where the word is missing.
fn count(result: &str, word: &str) -> u64 {
    let Some((before, _)) = result.split_once(word) else { return 0 };
    before.rsplit(' ').next().and_then(|number| number.parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_summed_and_other_lines_ignored() {
        let mut tally = Tally::default();
        for line in [
            "running 5 tests",
            "test a::b ... ok",
            "test result: ok. 5 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.01s",
            "test result: ok. 4 passed; 0 failed; 14 filtered out",
            "test prints a test result: ok. 90 passed; 9 failed;",
            "test result: FAILED. 12 passed; 3 failed; 1 ignored; 0 measured; 0 filtered out; finished in 2.50s",
        ] {
            tally.read(line);
        }
        assert_eq!(tally, Tally { passed: 21, failed: 3 });
    }
}
