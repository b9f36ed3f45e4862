//! Functions computed from strict operations alone, and therefore the same bits on every level.
