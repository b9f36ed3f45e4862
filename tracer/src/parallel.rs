//! Work over blocks of rays, a portion at a time, on the threads of the current rayon pool.

use crate::Error;
use rayon::prelude::*;

/// Blocks of sixteen rays in a portion: between two looks at a cancel flag, the unit that a thread takes.
const PORTION: usize = 64;

/// Calls `job` on portions of `input` and `output` (equally long), with the number of the portion's first block, and folds
/// what it returns. In a pool of one thread everything runs on the caller's.
///
/// # Errors
/// The first error of `job`.
pub(crate) fn portions<I: Sync, O: Send, R: Send>(
    input: &[I],
    output: &mut [O],
    job: impl Fn(usize, &[I], &mut [O]) -> Result<R, Error> + Sync,
    zero: impl Fn() -> R + Sync + Send,
    add: impl Fn(R, R) -> R + Sync + Send,
) -> Result<R, Error> {
    debug_assert_eq!(input.len(), output.len());
    if rayon::current_num_threads() == 1 {
        let mut portions = input.chunks(PORTION).zip(output.chunks_mut(PORTION)).enumerate();
        portions.try_fold(zero(), |sum, (i, (input, output))| Ok(add(sum, job(i * PORTION, input, output)?)))
    } else {
        let portions = input.par_chunks(PORTION).zip(output.par_chunks_mut(PORTION)).enumerate();
        portions.map(|(i, (input, output))| job(i * PORTION, input, output)).try_reduce(&zero, |a, b| Ok(add(a, b)))
    }
}
