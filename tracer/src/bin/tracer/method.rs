//! Which way of finding hits, and the tree it wants.

use clap::ValueEnum;
use simd::Level;
use tracer::Error;
use tracer::bvh::{Bvh, CollapseConfig, WideBvh};
use tracer::method::{Auto, Method, Order, Packet, Single, SlabForm, Width};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MethodChoice {
    /// Packets through the skip-pointer tree, as in the paper of 2003
    Packet,
    /// The same, near child first
    Ordered,
    /// Single rays through a tree of 4 children a node
    Single4,
    /// Of 8
    Single8,
    /// Of 16
    Single16,
    /// As many rays together as agree: the fastest for any rays, but its tree takes a quarter longer to build
    Auto,
}

/// What the method goes through, beside the binary tree.
pub enum Tree {
    Binary,
    Four(WideBvh<4>),
    Eight(WideBvh<8>),
    Sixteen(WideBvh<16>),
}

impl MethodChoice {
    /// Whether the number of rays in a packet can be chosen.
    pub fn has_packets(self) -> bool {
        matches!(self, Self::Packet | Self::Ordered)
    }

    /// # Errors
    /// If options that are for packets alone were given for another method.
    pub fn check(self, width: Width, form: SlabForm) -> Result<(), Error> {
        if !self.has_packets() && (width != Width::Auto || form != SlabForm::Exact) {
            return Err(Error::Usage("--width and --slab are for --method packet and ordered: leave them out".into()));
        }
        Ok(())
    }

    /// The name that options and reports use.
    pub fn name(self) -> String {
        self.to_possible_value().map(|value| value.get_name().to_string()).unwrap_or_default()
    }

    pub fn tree(self, bvh: &Bvh) -> Tree {
        let config = CollapseConfig::default();
        match self {
            Self::Packet | Self::Ordered => Tree::Binary,
            Self::Single4 => Tree::Four(bvh.collapse(&config)),
            Self::Single8 | Self::Auto => Tree::Eight(bvh.collapse(&config)),
            Self::Single16 => Tree::Sixteen(bvh.collapse(&config)),
        }
    }

    /// The method over what [`MethodChoice::tree`] made of `bvh`.
    pub fn over<'a>(
        self,
        bvh: &'a Bvh,
        tree: &'a Tree,
        level: Level,
        width: Width,
        form: SlabForm,
    ) -> Box<dyn Method + 'a> {
        let packet = Packet::new(bvh, level, width).with_form(form);
        match tree {
            Tree::Binary if self == Self::Ordered => Box::new(packet.with_order(Order::NearFirst)),
            Tree::Binary => Box::new(packet),
            Tree::Four(tree) => Box::new(Single::new(tree, level)),
            Tree::Eight(tree) if self == Self::Auto => Box::new(Auto::new(tree, level)),
            Tree::Eight(tree) => Box::new(Single::new(tree, level)),
            Tree::Sixteen(tree) => Box::new(Single::new(tree, level)),
        }
    }
}
