//! x
use super::Tree;
use super::primitive::Primitive;
use crate::Error;
use crate::progress::Progress;
/// x
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Config { /// x
    pub seed: Option<u64> }
pub(super) fn build(_p: Vec<Primitive>, _c: &Config, _g: &dyn Progress) -> Result<Tree, Error> { todo!() }
