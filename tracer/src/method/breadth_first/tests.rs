//! Every way of tracing finds the hits of a loop over all triangles.
