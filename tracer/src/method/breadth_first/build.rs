//! A frustum, or a few, for each packet (Garanzha & Loop 2010, section 3.2).

use crate::geometry::RayBlock;
use crate::geometry::frustum::{Frustum, Space, Survey};
use crate::lanes::Lanes;
use simd::Float;

/// The frusta of a portion of rays, packet by packet.
#[derive(Debug, Default)]
pub(super) struct Frusta {
    pub(super) all: Vec<Frustum>,
    /// Where those of each packet end.
    pub(super) ends: Vec<u32>,
    /// Blocks with rays that frusta are not for, and a bit for each of these.
    pub(super) odd: Vec<(u32, u16)>,
}

/// Makes frusta around packets, each of which is the blocks between two of `bases`.
pub(super) struct Build<'a> {
    pub(super) rays: &'a [RayBlock],
    pub(super) bases: &'a [u32],
    pub(super) space: &'a Space,
    pub(super) frusta: &'a mut Frusta,
}

impl Lanes for Build<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { rays, bases, space, frusta } = self;
        frusta.all.clear();
        frusta.ends.clear();
        frusta.odd.clear();
        for ends in bases.windows(2) {
            let blocks = &rays[ends[0] as usize..ends[1] as usize];
            let survey = Survey::new::<F>(blocks, space, &mut frusta.odd, ends[0]);
            survey.frusta::<F>(blocks, space, &mut frusta.all);
            frusta.ends.push(frusta.all.len() as u32);
        }
    }
}
