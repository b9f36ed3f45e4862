//! Which way of finding hits, and the tree it wants.

use clap::ValueEnum;
use simd::Level;
use std::sync::Arc;
use tracer::Error;
use tracer::bvh::{Bvh, CollapseConfig, OctoBvh, OctoConfig, WideBvh};
use tracer::geometry::Aabb;
use tracer::method::{
    Auto, BreadthFirst, DivideConquer, Method, Order, Packet, Reordering, Single, SlabForm, Sorted, Traversal,
    TriangleBoxes, Width,
};
use tracer::model::Mesh;
use tracer::sort::Reorder;

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum MethodChoice {
    /// Packets through the skip-pointer tree, as in the paper of 2003
    #[default]
    Packet,
    /// The same, near child first
    Ordered,
    /// Single rays through a tree of 4 children a node
    Single4,
    /// Of 8
    Single8,
    /// Of 16
    Single16,
    /// Each ray alone through the skip-pointer tree, as the paper of 2008 compares with
    BoulosSingle,
    /// As many rays together as a vector has lanes
    BoulosSimd,
    /// Packets of 64 that go where their first ray goes
    BoulosPacket,
    /// Packets of 256 whose rays are put into new order where few of them are active: the paper's method
    BoulosAdaptive,
    /// The same wherever one is not
    BoulosExact,
    /// Frusta around packets of sorted rays go through the tree level by level (the paper of 2010)
    BreadthFirst,
    /// No tree: triangles are divided while all rays are traced, the method of the paper of 2012
    DivideConquer,
    /// As many rays together as agree: the fastest for most rays; its tree takes a quarter longer to build
    Auto,
}

/// What a method goes through.
pub enum Tree {
    Binary(Arc<Bvh>),
    Four(WideBvh<4>),
    Eight(WideBvh<8>),
    Sixteen(WideBvh<16>),
    Octo(Arc<Bvh>, OctoBvh),
    /// None: the triangles alone.
    Boxes(TriangleBoxes),
}

impl MethodChoice {
    /// Whether the number of rays in a packet can be chosen.
    pub fn has_packets(self) -> bool {
        matches!(self, Self::Packet | Self::Ordered) || (self.is_plain_if_emulated() && self != Self::BoulosSingle)
    }

    /// Whether it has one lane at emulated levels, at any width.
    pub fn is_plain_if_emulated(self) -> bool {
        self.traversal().is_some() || matches!(self, Self::BreadthFirst | Self::DivideConquer)
    }

    fn traversal(self) -> Option<Traversal> {
        match self {
            Self::BoulosSingle => Some(Traversal::Single),
            Self::BoulosSimd => Some(Traversal::Simd),
            Self::BoulosPacket => Some(Traversal::Packet),
            Self::BoulosAdaptive => Some(Traversal::Adaptive),
            Self::BoulosExact => Some(Traversal::Exact),
            _ => None,
        }
    }

    /// # Errors
    /// If options that are for packets alone were given for another method.
    pub fn check(self, width: Width, form: SlabForm) -> Result<(), Error> {
        if !self.has_packets() && width != Width::Auto {
            let message = "--width is for --method packet, ordered, boulos-simd to -exact, breadth-first and divide-conquer: leave it out";
            return Err(Error::Usage(message.into()));
        }
        if !matches!(self, Self::Packet | Self::Ordered) && form != SlabForm::Exact {
            return Err(Error::Usage("--slab is for --method packet and ordered: leave it out".into()));
        }
        Ok(())
    }

    /// The name that options and reports use.
    pub fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_string()).unwrap_or_default()
    }

    /// What it goes through, made of a mesh, or of the binary tree over it if it wants one.
    ///
    /// # Errors
    /// If the scene is too large for it, and those of `bvh`.
    pub fn tree(self, mesh: &Mesh, bvh: impl FnOnce() -> Result<Arc<Bvh>, Error>) -> Result<Tree, Error> {
        if self == Self::DivideConquer {
            return Ok(Tree::Boxes(TriangleBoxes::new(mesh)?));
        }
        let (bvh, config) = (bvh()?, CollapseConfig::default());
        Ok(match self {
            Self::Single4 => Tree::Four(bvh.collapse(&config)),
            Self::Single8 | Self::Auto => Tree::Eight(bvh.collapse(&config)),
            Self::Single16 => Tree::Sixteen(bvh.collapse(&config)),
            Self::BreadthFirst => {
                let octo = OctoBvh::new(&bvh, &OctoConfig::default())?;
                Tree::Octo(bvh, octo)
            }
            _ => Tree::Binary(bvh),
        })
    }

    /// The method over what [`MethodChoice::tree`] made.
    pub fn over(self, tree: &Tree, level: Level, width: Width, form: SlabForm) -> Box<dyn Method + '_> {
        match tree {
            Tree::Binary(bvh) => {
                if let Some(traversal) = self.traversal() {
                    return Box::new(Reordering::new(bvh, level, width, traversal));
                }
                let order = if self == Self::Ordered { Order::NearFirst } else { Order::Stored };
                Box::new(Packet::new(bvh, level, width).with_form(form).with_order(order))
            }
            Tree::Four(tree) => Box::new(Single::new(tree, level)),
            Tree::Eight(tree) if self == Self::Auto => Box::new(Auto::new(tree, level)),
            Tree::Eight(tree) => Box::new(Single::new(tree, level)),
            Tree::Sixteen(tree) => Box::new(Single::new(tree, level)),
            Tree::Boxes(triangles) => Box::new(DivideConquer::new(triangles, level, width)),
            Tree::Octo(bvh, tree) => Box::new(BreadthFirst::new(bvh, tree, level, width)),
        }
    }
}

/// The same with rays put into order before it, in a scene's box.
pub fn reordered<'a>(method: Box<dyn Method + 'a>, bounds: &Aabb, level: Level, by: Reorder) -> Box<dyn Method + 'a> {
    if by == Reorder::None { method } else { Box::new(Sorted::new(method, level, bounds, by)) }
}
