//! What the paper printed.

/// Sizes of cells of table 1 ("UserCellFraction"), of the scene's diagonal.
pub const CELLS: [f32; 4] = [0.002, 0.004, 0.008, 0.016];
/// Most rays in a packet of table 1 ("MaxSize").
pub const PACKETS: [usize; 3] = [128, 256, 512];

/// Table 1, its figures 11(a), the Fairy Forest, and 11(c) and (d), which are its other scenes: thousands of leaves, thousands of frusta, rays a warp of 32.
pub const TABLE_1: [[[[f64; 3]; 3]; 4]; 3] = [
    [
        [[681.0, 108.0, 31.0], [859.0, 119.0, 30.0], [721.0, 77.0, 30.8]],
        [[668.0, 97.0, 31.6], [691.0, 91.0, 30.9], [610.0, 66.0, 31.4]],
        [[690.0, 91.0, 31.9], [618.0, 78.0, 31.7], [557.0, 60.0, 31.8]],
        [[709.0, 89.0, 31.9], [640.0, 74.0, 31.9], [546.0, 59.0, 31.9]],
    ],
    [
        [[521.0, 80.0, 30.5], [945.0, 116.0, 29.0], [512.0, 50.0, 30.9]],
        [[444.0, 57.0, 31.5], [572.0, 62.0, 30.8], [378.0, 37.0, 31.5]],
        [[445.0, 48.0, 31.9], [438.0, 44.0, 31.6], [318.0, 32.0, 31.8]],
        [[500.0, 46.0, 31.9], [447.0, 39.0, 31.9], [303.0, 30.0, 31.9]],
    ],
    [
        [[430.0, 66.0, 30.6], [792.0, 96.0, 29.5], [494.0, 45.0, 30.8]],
        [[317.0, 35.0, 31.5], [431.0, 44.0, 31.0], [283.0, 25.0, 31.5]],
        [[313.0, 26.0, 31.8], [303.0, 26.0, 31.6], [189.0, 14.0, 31.8]],
        [[328.0, 24.0, 31.9], [294.0, 21.0, 31.9], [171.0, 16.0, 31.9]],
    ],
];

/// Speed-up of eight children a node over two, for breadth-first traversal (section 5.5).
pub const EIGHT_OVER_TWO: f64 = 2.0;
/// Of breadth-first over depth-first traversal of frusta.
pub const BREADTH_OVER_DEPTH: f64 = 5.0;
/// Of the whole over depth-first tracing of single rays in one kernel, their sort not counted (abstract).
pub const OVER_SINGLE: f64 = 3.0;
