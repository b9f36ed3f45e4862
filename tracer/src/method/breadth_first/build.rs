//! A frustum, or a few, for each packet (Garanzha & Loop 2010, section 3.2).

use super::runs::Runs;
use crate::geometry::RayBlock;
use crate::geometry::frustum::{Frustum, Space, Survey};
use crate::lanes::Lanes;
use simd::Float;

/// The frusta of a portion of rays, run by run.
#[derive(Debug, Default)]
pub(super) struct Frusta {
    pub(super) all: Vec<Frustum>,
    /// Where those of each run end.
    pub(super) ends: Vec<u32>,
    /// Blocks with rays that frusta are not for, and a bit for each of these.
    pub(super) odd: Vec<(u32, u16)>,
}

impl Frusta {
    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let (all, ends, odd) = (self.all.capacity(), self.ends.capacity(), self.odd.capacity());
        size_of::<Frustum>() * all + size_of::<u32>() * ends + size_of::<(u32, u16)>() * odd
    }
}

/// Makes frusta around packets.
pub(super) struct Build<'a> {
    pub(super) rays: &'a [RayBlock],
    pub(super) runs: Runs<'a>,
    pub(super) space: &'a Space,
    pub(super) frusta: &'a mut Frusta,
}

impl Lanes for Build<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { rays, runs, space, frusta } = self;
        frusta.all.clear();
        frusta.ends.clear();
        frusta.odd.clear();
        let mut run = 0;
        while run < runs.len() {
            let ([begin, end], mut rest) = (runs.blocks(run), runs.cuts[run]);
            let blocks = &rays[begin as usize..end as usize];
            while rest != 0 {
                // From a cut to the next.
                let after = rest & (rest - 1);
                let lanes = (u16::MAX << rest.trailing_zeros())
                    ^ if after == 0 { 0 } else { u16::MAX << after.trailing_zeros() };
                let survey = Survey::new::<F>(blocks, lanes, space, &mut frusta.odd, begin);
                survey.frusta::<F>(blocks, space, &mut frusta.all);
                rest = after;
            }
            frusta.ends.push(frusta.all.len() as u32);
            run += 1;
        }
    }
}
