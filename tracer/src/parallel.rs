//! Work over blocks of rays, a portion at a time, on the threads of the current rayon pool.

use crate::Error;
use rayon::prelude::*;

/// Blocks of sixteen rays in a portion where nothing else is wanted.
pub(crate) const PORTION: usize = 64;

/// Calls `job` on portions of `size` elements of `input` and `output` (equally long), with the number of the portion's first,
/// and folds what it returns. Portions are what a thread takes, and between two there is a look at a cancel flag. In a pool of one thread everything runs on the caller's.
///
/// # Errors
/// The first error of `job`.
pub(crate) fn portions<I: Sync, O: Send, R: Send>(
    size: usize,
    input: &[I],
    output: &mut [O],
    job: impl Fn(usize, &[I], &mut [O]) -> Result<R, Error> + Sync,
    zero: impl Fn() -> R + Sync + Send,
    add: impl Fn(R, R) -> R + Sync + Send,
) -> Result<R, Error> {
    debug_assert_eq!(input.len(), output.len());
    if rayon::current_num_threads() == 1 {
        let mut portions = input.chunks(size).zip(output.chunks_mut(size)).enumerate();
        portions.try_fold(zero(), |sum, (i, (input, output))| Ok(add(sum, job(i * size, input, output)?)))
    } else {
        let portions = input.par_chunks(size).zip(output.par_chunks_mut(size)).enumerate();
        portions.map(|(i, (input, output))| job(i * size, input, output)).try_reduce(&zero, |a, b| Ok(add(a, b)))
    }
}
