//! What the paper printed: tables 1 to 4 of Boulos, Wald and Benthin 2008, measured with SSE on one core of a 3.0 GHz Clovertown.

use super::scenes::{Name, Surface};

/// One of tables 1 to 3.
pub struct Table {
    /// Its number.
    pub number: u32,
    /// What all surfaces are.
    pub surface: Surface,
    /// Reflections at most: the upper, middle and lower part of the table.
    pub bounces: [u32; 3],
    /// For each of these, Sponza, Fairy and Conference.
    pub rows: [[Row; 3]; 3],
}

/// A line of tables 1 to 3.
#[derive(Clone, Copy)]
pub struct Row {
    /// Seconds for a frame by single rays, SIMD groups, packets and with reordering.
    pub seconds: [f64; 4],
    /// Of the last three, over single rays.
    pub speed_ups: [f64; 3],
}

const fn row(single: f64, simd: [f64; 2], packet: [f64; 2], reordered: [f64; 2]) -> Row {
    Row { seconds: [single, simd[0], packet[0], reordered[0]], speed_ups: [simd[1], packet[1], reordered[1]] }
}

/// Tables 1 to 3.
pub const TABLES: [Table; 3] = [
    Table {
        number: 1,
        surface: Surface::Specular,
        bounces: [2, 5, 10],
        rows: [
            [
                row(7.7, [3.4, 2.2], [2.1, 3.7], [2.5, 3.1]),
                row(5.5, [2.9, 1.9], [2.2, 2.6], [2.2, 2.5]),
                row(7.8, [4.2, 1.9], [2.8, 2.8], [2.8, 2.8]),
            ],
            [
                row(15.4, [8.0, 1.9], [6.6, 2.3], [7.3, 2.1]),
                row(7.5, [4.4, 1.7], [3.8, 2.0], [3.5, 2.1]),
                row(17.3, [10.0, 1.7], [8.2, 2.1], [7.9, 2.2]),
            ],
            [
                row(27.6, [18.5, 1.5], [22.1, 1.2], [21.0, 1.3]),
                row(9.5, [6.0, 1.6], [5.8, 1.6], [4.8, 2.0]),
                row(32.2, [22.8, 1.4], [24.4, 1.3], [22.0, 1.5]),
            ],
        ],
    },
    Table {
        number: 2,
        surface: Surface::Glossy,
        bounces: [0, 1, 2],
        rows: [
            [
                row(2.4, [1.0, 2.4], [0.5, 4.8], [0.7, 3.4]),
                row(2.1, [1.1, 1.9], [0.8, 2.6], [0.8, 2.6]),
                row(2.3, [1.2, 1.9], [0.9, 2.6], [0.8, 2.9]),
            ],
            [
                row(5.2, [2.9, 1.8], [2.2, 2.4], [2.2, 2.4]),
                row(4.4, [2.5, 1.8], [2.2, 2.0], [2.0, 2.2]),
                row(5.0, [2.9, 1.7], [2.4, 2.1], [2.0, 2.5]),
            ],
            [
                row(8.2, [5.3, 1.5], [4.9, 1.7], [4.3, 1.9]),
                row(5.8, [3.8, 1.5], [3.7, 1.6], [3.0, 1.9]),
                row(8.0, [5.2, 1.5], [4.9, 1.6], [3.9, 2.1]),
            ],
        ],
    },
    Table {
        number: 3,
        surface: Surface::Diffuse,
        bounces: [0, 1, 2],
        rows: [
            [
                row(2.4, [1.0, 2.4], [0.5, 4.8], [0.6, 4.0]),
                row(2.1, [1.0, 2.1], [0.8, 2.6], [0.8, 2.6]),
                row(2.3, [1.2, 1.9], [0.9, 2.6], [0.7, 3.3]),
            ],
            [
                row(6.0, [3.9, 1.5], [4.4, 1.4], [3.4, 1.8]),
                row(4.1, [2.7, 1.5], [3.0, 1.4], [2.2, 1.9]),
                row(5.0, [3.3, 1.5], [3.7, 1.4], [2.6, 1.9]),
            ],
            [
                row(8.8, [7.3, 1.2], [9.8, 0.9], [7.2, 1.2]),
                row(5.3, [4.1, 1.3], [5.0, 1.1], [3.1, 1.7]),
                row(8.0, [6.0, 1.3], [7.7, 1.0], [5.3, 1.5]),
            ],
        ],
    },
];

/// Table 4, per ray, for the five traversals: Conference, diffuse, 2 bounces.
pub const TABLE_4: [(&str, [f64; 5]); 6] = [
    ("Box", [46.6, 23.1, 49.4, 16.3, 14.0]),
    ("IA", [0.0, 0.0, 6.7, 0.2, 0.2]),
    ("Reorder", [0.0, 0.0, 0.0, 3.2, 8.9]),
    ("Tri", [6.0, 4.7, 7.5, 4.9, 4.2]),
    ("Trav", [46.6, 23.1, 7.9, 4.5, 4.5]),
    ("Prim", [6.0, 4.7, 3.1, 2.2, 2.2]),
];

/// The table of a kind of surface.
pub fn table(surface: Surface) -> &'static Table {
    match surface {
        Surface::Specular => &TABLES[0],
        Surface::Glossy => &TABLES[1],
        Surface::Diffuse => &TABLES[2],
    }
}

impl Table {
    /// The line of a scene in a part of the table.
    pub fn row(&self, part: usize, scene: Name) -> Row {
        self.rows[part][scene as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each speed-up can be the quotient of the two times, all three rounded to a tenth.
    #[test]
    fn speed_ups_fit_the_seconds() {
        for table in &TABLES {
            for row in table.rows.as_flattened() {
                let [single, others @ ..] = row.seconds;
                for (seconds, speed_up) in others.into_iter().zip(row.speed_ups) {
                    let (low, high) = ((single - 0.05) / (seconds + 0.05), (single + 0.05) / (seconds - 0.05));
                    let fits = low - 0.0501 <= speed_up && speed_up <= high + 0.0501;
                    assert!(fits, "table {}: {single} / {seconds} is printed as {speed_up}", table.number);
                }
            }
        }
    }

    /// Sums of the columns, added up from the print a second time.
    #[test]
    fn totals() {
        let tenths = |x: f64| (10.0 * x).round() as i64;
        for (table, expected) in TABLES.iter().zip([[1305, 802, 780, 740], [434, 259, 225, 197], [440, 305, 358, 259]])
        {
            let sum = |column| table.rows.as_flattened().iter().map(|row| tenths(row.seconds[column])).sum::<i64>();
            assert_eq!([0, 1, 2, 3].map(sum), expected, "table {}", table.number);
        }
        let sum = |column: usize| TABLE_4.iter().map(|(_, row)| tenths(row[column])).sum::<i64>();
        assert_eq!([0, 1, 2, 3, 4].map(sum), [1052, 556, 746, 313, 340]);
    }

    #[test]
    fn each_surface_has_its_table() {
        for table in &TABLES {
            assert_eq!(super::table(table.surface).number, table.number);
        }
        assert_eq!(table(Surface::Diffuse).row(2, Name::Conference).seconds, [8.0, 6.0, 7.7, 5.3]);
    }
}
