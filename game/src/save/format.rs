//! The container that saves and replay logs share: a header that can be listed without unpacking, and a checked payload.
//!
//! | offset | bytes | what |
//! |---|---|---|
//! | 0 | 8 | magic: [`SAVE`] or [`LOG`] |
//! | 8 | 2 | version of the format |
//! | 10 | 2 | length of the header up to the payload |
//! | 12 | 8 | when it was written, s since 1970 UTC (for the list only) |
//! | 20 | 8 | order of writing: the largest of a folder is the newest |
//! | 28 | 8 | simulated time, ticks since J2000 TDB |
//! | 36 | 8 | altitude above the datum, m |
//! | 44 | 8 | length of the payload, packed |
//! | 52 | 8 | length of the payload, unpacked |
//! | 60 | 2 + n | body: length and UTF-8 |
//! | … | 32 | blake3 of everything before it and of the payload |
//! | … | … | payload: zstd |
//!
//! Numbers are little-endian. A version above the known one is reported before anything else is read, so that a newer
//! program may change all that follows. Not here: what the payload means ([`super::v1`], [`crate::replay::log`]).

use engine::time::SimTime;
use std::io::Read;

/// A family of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Family {
    /// First bytes of the file.
    pub magic: [u8; 8],
    /// Newest version that this program knows.
    pub version: u16,
    /// The name used in messages.
    pub name: &'static str,
}

/// Saves.
pub const SAVE: Family = Family { magic: *b"SYZYSAVE", version: 1, name: "save" };
/// Replay logs.
pub const LOG: Family = Family { magic: *b"SYZYGLOG", version: 1, name: "replay log" };

/// Largest payload that is unpacked, bytes: a bound against a file that claims the moon.
pub const LARGEST_PAYLOAD: u64 = 64 << 20;
const FIXED: usize = 62;
const HASH: usize = 32;

/// What a list shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// When it was written, s since 1970 UTC.
    pub written_unix_s: i64,
    /// Order of writing.
    pub sequence: u64,
    /// Simulated time.
    pub time: SimTime,
    /// Key of the dominating body.
    pub body: String,
    /// Altitude above the datum, m.
    pub altitude_m: f64,
}

/// What may be wrong with a container.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FormatError {
    /// Not this kind of file.
    #[error("byte 0: this is not a Syzygy {expected}: expected the file to begin with {expected_magic}, found {found}")]
    Magic {
        /// The family's name.
        expected: &'static str,
        /// Its magic, readable.
        expected_magic: String,
        /// What stands there.
        found: String,
    },
    /// Written by a newer program.
    #[error("byte 8: this {name} has format {found}, this program knows up to {known}: use a newer Syzygy; the file was left untouched")]
    Newer {
        /// The family's name.
        name: &'static str,
        /// The version found.
        found: u16,
        /// The newest known.
        known: u16,
    },
    /// Ends before it should.
    #[error("byte {found}: the {name} ends here, expected {expected} bytes: it was cut off")]
    CutOff {
        /// The family's name.
        name: &'static str,
        /// Length expected, bytes.
        expected: u64,
        /// Length found, bytes.
        found: u64,
    },
    /// Goes on after its end.
    #[error("byte {expected}: expected the {name} to end here, {extra} more bytes follow")]
    Trailing {
        /// The family's name.
        name: &'static str,
        /// Length expected, bytes.
        expected: u64,
        /// Bytes too many.
        extra: u64,
    },
    /// The header holds what no program of ours writes.
    #[error("byte {offset}: the {name}'s header is damaged: {what}")]
    Header {
        /// The family's name.
        name: &'static str,
        /// Where, bytes.
        offset: usize,
        /// What is wrong.
        what: String,
    },
    /// The bytes are not those that were written.
    #[error("byte {offset}: the checksum of the {name} does not match: expected {expected}, computed {found}: it is damaged")]
    Checksum {
        /// The family's name.
        name: &'static str,
        /// Where the checksum stands, bytes.
        offset: usize,
        /// First half of the checksum in the file, hex.
        expected: String,
        /// First half of the checksum of the bytes, hex.
        found: String,
    },
    /// The payload does not unpack.
    #[error("byte {offset}: the {name}'s payload does not unpack: {what}")]
    Payload {
        /// The family's name.
        name: &'static str,
        /// Where the payload begins, bytes.
        offset: usize,
        /// What is wrong.
        what: String,
    },
}

impl FormatError {
    /// True when nothing is wrong with the file but that it is from the future.
    pub fn is_newer(&self) -> bool {
        matches!(self, Self::Newer { .. })
    }
}

/// Wraps a payload.
///
/// # Errors
/// [`FormatError::Payload`] when it is too large or cannot be packed.
pub fn wrap(family: Family, header: &Header, payload: &[u8]) -> Result<Vec<u8>, FormatError> {
    let bad = |what: String| FormatError::Payload { name: family.name, offset: 0, what };
    if payload.len() as u64 > LARGEST_PAYLOAD {
        return Err(bad(format!("{} bytes, at most {LARGEST_PAYLOAD} can be kept", payload.len())));
    }
    let packed = zstd::encode_all(payload, 9).map_err(|e| bad(e.to_string()))?;
    let body = header.body.as_bytes();
    let body_len = u16::try_from(body.len()).ok().filter(|n| *n <= 256).ok_or_else(|| bad("the body's name is too long".into()))?;
    let length = u16::try_from(FIXED + body.len() + HASH).map_err(|_| bad("the header is too long".into()))?;
    let mut out = Vec::with_capacity(usize::from(length) + packed.len());
    out.extend(family.magic);
    out.extend(family.version.to_le_bytes());
    out.extend(length.to_le_bytes());
    out.extend(header.written_unix_s.to_le_bytes());
    out.extend(header.sequence.to_le_bytes());
    out.extend(header.time.ticks.to_le_bytes());
    out.extend(header.altitude_m.to_le_bytes());
    out.extend((packed.len() as u64).to_le_bytes());
    out.extend((payload.len() as u64).to_le_bytes());
    out.extend(body_len.to_le_bytes());
    out.extend(body);
    let hash = checksum(&out, &packed);
    out.extend(hash.as_bytes());
    out.extend(packed);
    Ok(out)
}

/// Reads and checks a container.
///
/// # Errors
/// [`FormatError`], naming the byte.
pub fn unwrap(family: Family, bytes: &[u8]) -> Result<(Header, Vec<u8>), FormatError> {
    let name = family.name;
    let (header, sizes) = read_header(family, bytes)?;
    let at = sizes.header;
    let total = at as u64 + sizes.packed;
    let found = bytes.len() as u64;
    if found < total {
        return Err(FormatError::CutOff { name, expected: total, found });
    }
    if found > total {
        return Err(FormatError::Trailing { name, expected: total, extra: found - total });
    }
    let (head, packed) = bytes.split_at(at);
    let (head, stored) = head.split_at(at - HASH);
    let computed = checksum(head, packed);
    if computed.as_bytes() != stored {
        let hex = |b: &[u8]| b.iter().take(HASH / 2).map(|x| format!("{x:02x}")).collect::<String>();
        return Err(FormatError::Checksum { name, offset: at - HASH, expected: hex(stored), found: hex(computed.as_bytes()) });
    }
    let bad = |what: String| FormatError::Payload { name, offset: at, what };
    let mut payload = Vec::new();
    let decoder = zstd::stream::read::Decoder::new(packed).map_err(|e| bad(e.to_string()))?;
    // One byte more than claimed is enough to see that the claim is wrong.
    decoder.take(sizes.unpacked + 1).read_to_end(&mut payload).map_err(|e| bad(e.to_string()))?;
    if payload.len() as u64 != sizes.unpacked {
        return Err(bad(format!("expected {} bytes, found {} or more", sizes.unpacked, payload.len())));
    }
    Ok((header, payload))
}

/// Lengths that the header claims.
struct Sizes {
    header: usize,
    packed: u64,
    unpacked: u64,
}

fn read_header(family: Family, bytes: &[u8]) -> Result<(Header, Sizes), FormatError> {
    let name = family.name;
    let cut = |expected: usize| FormatError::CutOff { name, expected: expected as u64, found: bytes.len() as u64 };
    let damaged = |offset: usize, what: String| FormatError::Header { name, offset, what };
    if bytes.is_empty() {
        return Err(cut(FIXED + HASH));
    }
    let magic = &bytes[..bytes.len().min(8)];
    if magic != &family.magic[..magic.len()] {
        return Err(FormatError::Magic {
            expected: name,
            expected_magic: family.magic.escape_ascii().to_string(),
            found: magic.escape_ascii().to_string(),
        });
    }
    let mut reader = Reader { bytes, at: 8 };
    let version = u16::from_le_bytes(reader.take().ok_or_else(|| cut(FIXED + HASH))?);
    if version > family.version {
        return Err(FormatError::Newer { name, found: version, known: family.version });
    }
    if version == 0 {
        return Err(damaged(8, "format 0 was never written".into()));
    }
    let mut fixed = || -> Option<_> {
        Some((
            u16::from_le_bytes(reader.take()?),
            i64::from_le_bytes(reader.take()?),
            u64::from_le_bytes(reader.take()?),
            i64::from_le_bytes(reader.take()?),
            f64::from_le_bytes(reader.take()?),
            u64::from_le_bytes(reader.take()?),
            u64::from_le_bytes(reader.take()?),
            u16::from_le_bytes(reader.take()?),
        ))
    };
    let (length, written_unix_s, sequence, ticks, altitude_m, packed, unpacked, body_len) = fixed().ok_or_else(|| cut(FIXED + HASH))?;
    let header = FIXED + usize::from(body_len) + HASH;
    if usize::from(length) != header || body_len > 256 {
        return Err(damaged(10, format!("a length of {length} bytes with a name of {body_len} bytes, expected {header} in all")));
    }
    if unpacked > LARGEST_PAYLOAD || packed > LARGEST_PAYLOAD {
        return Err(damaged(44, format!("it claims {packed} bytes packed, {unpacked} unpacked; at most {LARGEST_PAYLOAD} can be")));
    }
    let body = bytes.get(FIXED..FIXED + usize::from(body_len)).ok_or_else(|| cut(header))?;
    let body = std::str::from_utf8(body).map_err(|e| damaged(FIXED, format!("the body's name: {e}")))?.to_owned();
    if bytes.len() < header {
        return Err(cut(header));
    }
    if !altitude_m.is_finite() {
        return Err(damaged(36, format!("the altitude is {altitude_m}, expected a finite number")));
    }
    Ok((Header { written_unix_s, sequence, time: SimTime::from_ticks(ticks), body, altitude_m }, Sizes { header, packed, unpacked }))
}

fn checksum(header: &[u8], packed: &[u8]) -> blake3::Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(header);
    hasher.update(packed);
    hasher.finalize()
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let out = self.bytes.get(self.at..self.at + N)?.try_into().ok()?;
        self.at += N;
        Some(out)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header() -> Header {
        Header { written_unix_s: 1_790_000_000, sequence: 7, time: SimTime::from_ticks(-3), body: "earth".into(), altitude_m: 4.2e5 }
    }

    fn sample() -> Vec<u8> {
        wrap(SAVE, &header(), b"plain words, plain words, plain words").unwrap()
    }

    /// Makes the checksum right again after a change: what a careless editor, not damage, would leave.
    fn resealed(mut bytes: Vec<u8>) -> Vec<u8> {
        let at = usize::from(u16::from_le_bytes([bytes[10], bytes[11]]));
        let hash = checksum(&bytes[..at - HASH], &bytes[at..]);
        bytes[at - HASH..at].copy_from_slice(hash.as_bytes());
        bytes
    }

    #[test]
    fn what_goes_in_comes_out() {
        let (h, payload) = unwrap(SAVE, &sample()).unwrap();
        assert_eq!((h, payload.as_slice()), (header(), b"plain words, plain words, plain words".as_slice()));
    }

    #[test]
    fn no_length_but_the_right_one_is_taken() {
        let all = sample();
        for n in 0..all.len() {
            let e = unwrap(SAVE, &all[..n]).unwrap_err();
            assert!(matches!(e, FormatError::CutOff { found, .. } if found == n as u64), "{n}: {e}");
        }
        let mut more = all;
        more.extend([0, 0]);
        assert!(matches!(unwrap(SAVE, &more), Err(FormatError::Trailing { extra: 2, .. })));
    }

    #[test]
    fn every_flipped_bit_is_seen() {
        let all = sample();
        for bit in 0..all.len() * 8 {
            let mut bent = all.clone();
            bent[bit / 8] ^= 1 << (bit % 8);
            assert!(unwrap(SAVE, &bent).is_err(), "bit {bit}");
        }
    }

    #[test]
    fn a_newer_format_is_told_apart_from_damage() {
        let mut newer = sample();
        newer[8] = 2;
        newer.truncate(30);
        let e = unwrap(SAVE, &newer).unwrap_err();
        assert!(e.is_newer() && e.to_string().contains("untouched"), "{e}");
        assert!(matches!(unwrap(LOG, &sample()), Err(FormatError::Magic { .. })));
    }

    #[test]
    fn a_claim_beyond_the_bound_is_refused_before_memory_is_asked_for() {
        for field in [44, 52] {
            let mut vast = sample();
            vast[field..field + 8].copy_from_slice(&u64::MAX.to_le_bytes());
            assert!(matches!(unwrap(SAVE, &resealed(vast)), Err(FormatError::Header { offset: 44, .. })));
        }
        // A bomb: packs to little, unpacks to more than it says.
        let mut bomb = wrap(SAVE, &header(), &vec![0; 1 << 20]).unwrap();
        bomb[52..60].copy_from_slice(&10_u64.to_le_bytes());
        let e = unwrap(SAVE, &resealed(bomb)).unwrap_err();
        assert!(matches!(&e, FormatError::Payload { what, .. } if what.contains("expected 10 bytes, found 11")), "{e}");
    }
}
