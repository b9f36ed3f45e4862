//! Constant tables of backends: where [`Vector::compress`](crate::Vector::compress) takes its lanes from.

/// By bit mask: the bytes of the lanes that are on, one after the other; then 0x90, which stands for a zero:
/// its top bit is set, it is above 15, and modulo 32 it is 16, whichever a processor looks at.
pub(super) static COMPRESS4: [[u8; 16]; 16] = {
    let mut table = [[0x90; 16]; 16];
    let mut mask = 0;
    while mask < 16 {
        let (mut lane, mut n) = (0, 0);
        while lane < 4 {
            if mask >> lane & 1 != 0 {
                let mut byte = 0;
                while byte < 4 {
                    table[mask][4 * n + byte] = (4 * lane + byte) as u8;
                    byte += 1;
                }
                n += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// By bit mask: the lanes that are on, one after the other; then -1, which stands for a zero. As wide as the lanes themselves:
/// eight kilobytes, but no conversion on the way.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(super) static COMPRESS8: [Lanes8; 256] = {
    let mut table = [Lanes8([-1; 8]); 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut n) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 != 0 {
                table[mask].0[n] = lane;
                n += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// Of a register of 32 bytes, aligned for it.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[derive(Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Lanes8(pub(super) [i32; 8]);
