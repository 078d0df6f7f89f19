//! The container of the RGL material database (W. Jakob): named arrays of
//! numbers.
//!
//! Little-endian throughout: the 12 bytes `tensor_file\0`; two bytes of version, 1
//! and 0; u32 number of fields; then for each field u16 length of its name, the
//! name, u16 number of dimensions, u8 type, u64 offset of its data from the
//! start of the file, and u64 for each dimension, slowest first.

use super::bytes::{Cursor, FormatError};

pub(super) const NAME: &str = "tensor file";

/// What a tensor file begins with.
pub const MAGIC: &[u8; 12] = b"tensor_file\0";

/// The only version there is.
const VERSION: [u8; 2] = [1, 0];

/// The type of the numbers of a field, by its number in the file less 1: integers
/// and floats of these many bytes.
const TYPES: [(&str, usize); 11] = [
    ("u8", 1),
    ("i8", 1),
    ("u16", 2),
    ("i16", 2),
    ("u32", 4),
    ("i32", 4),
    ("u64", 8),
    ("i64", 8),
    ("f16", 2),
    ("f32", 4),
    ("f64", 8),
];

/// Numbers of the types that BSDF files use.
const U8: u8 = 1;
const F32: u8 = 10;

/// A field: an array with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<'a> {
    /// Its name.
    pub name: String,
    dtype: u8,
    /// Its dimensions, slowest first.
    pub shape: Vec<usize>,
    /// Where its data begin.
    pub offset: usize,
    data: &'a [u8],
}

/// The fields of a tensor file.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorFile<'a> {
    /// In the order of the file.
    pub fields: Vec<Field<'a>>,
}

impl<'a> TensorFile<'a> {
    /// Reads the content of a file: every field's data must lie within it.
    pub fn read(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let mut cursor = Cursor::new(NAME, bytes);
        let magic = cursor.take(MAGIC.len(), "`tensor_file` and a zero")?;
        if magic != MAGIC {
            return Err(FormatError::new(NAME, 0, "it does not begin with `tensor_file` and a zero"));
        }
        let at = cursor.offset();
        let version = [cursor.u8("the version")?, cursor.u8("the version")?];
        if version != VERSION {
            let [major, minor] = version;
            return Err(FormatError::new(
                NAME,
                at,
                format!("version {major}.{minor} is not known, only 1.0"),
            ));
        }
        let count = cursor.u32("the number of fields")?;
        let mut fields: Vec<Field> = Vec::new();
        for k in 0..count {
            let at = cursor.offset();
            let field = field(&mut cursor, bytes, k)?;
            if fields.iter().any(|f| f.name == field.name) {
                return Err(FormatError::new(NAME, at, format!("field `{}` is there twice", field.name)));
            }
            fields.push(field);
        }
        Ok(Self { fields })
    }

    /// The field `name`.
    pub fn field(&self, name: &str) -> Option<&Field<'a>> {
        self.fields.iter().find(|f| f.name == name)
    }

    /// The names of all fields.
    pub fn names(&self) -> String {
        let names: Vec<&str> = self.fields.iter().map(|f| f.name.as_str()).collect();
        if names.is_empty() { "none".into() } else { names.join(", ") }
    }
}

fn field<'a>(cursor: &mut Cursor<'a>, bytes: &'a [u8], k: u32) -> Result<Field<'a>, FormatError> {
    let of = |what: &str| format!("{what} of field {k}");
    let length = cursor.u16(&of("the length of the name"))?;
    let name = String::from_utf8_lossy(cursor.take(length.into(), &of("the name"))?).into_owned();
    let dimensions = cursor.u16(&format!("the number of dimensions of `{name}`"))?;
    let at = cursor.offset();
    let dtype = cursor.u8(&format!("the type of `{name}`"))?;
    let Some((type_name, size)) = usize::from(dtype).checked_sub(1).and_then(|k| TYPES.get(k)) else {
        return Err(FormatError::new(NAME, at, format!("`{name}` has the unknown type {dtype}")));
    };
    let at = cursor.offset();
    let offset = cursor.u64(&format!("the offset of `{name}`"))?;
    let mut shape = Vec::new();
    for _ in 0..dimensions {
        shape.push(cursor.u64(&format!("the shape of `{name}`"))?);
    }
    let length = shape.iter().try_fold(*size as u64, |product, n| product.checked_mul(*n));
    let end = length.and_then(|length| offset.checked_add(length)).filter(|end| *end <= bytes.len() as u64);
    let Some(end) = end else {
        let message = format!(
            "`{name}`, {type_name} of shape {shape:?} from byte {offset} on, goes beyond the end of the file \
             at {}",
            bytes.len()
        );
        return Err(FormatError::new(NAME, at, message));
    };
    let (offset, end) = (offset as usize, end as usize);
    let shape = shape.into_iter().map(|n| n as usize).collect();
    Ok(Field { name, dtype, shape, offset, data: &bytes[offset..end] })
}

impl Field<'_> {
    /// Name of its type.
    pub fn type_name(&self) -> &'static str {
        TYPES[usize::from(self.dtype) - 1].0
    }

    /// Its bytes, if it has one.
    pub fn bytes(&self) -> Result<&[u8], FormatError> {
        self.expect(U8)?;
        Ok(self.data)
    }

    /// Its values, each of which must satisfy `holds`; `must` says what that is.
    pub fn floats(&self, must: &str, holds: impl Fn(f32) -> bool) -> Result<Vec<f64>, FormatError> {
        self.expect(F32)?;
        let value = |(k, four): (usize, &[u8])| {
            let v = f32::from_le_bytes(four.try_into().expect("chunks of four"));
            if holds(v) {
                return Ok(f64::from(v));
            }
            let message = format!("value {k} of `{}` is {v}; it must be {must}", self.name);
            Err(FormatError::new(NAME, self.offset + 4 * k, message))
        };
        self.data.chunks_exact(4).enumerate().map(value).collect()
    }

    fn expect(&self, dtype: u8) -> Result<(), FormatError> {
        if self.dtype == dtype {
            return Ok(());
        }
        let (found, wanted) = (self.type_name(), TYPES[usize::from(dtype) - 1].0);
        let message = format!("`{}` holds {found}, where {wanted} belongs", self.name);
        Err(FormatError::new(NAME, self.offset, message))
    }
}

/// What a field of a new file holds.
pub enum Content {
    /// Bytes.
    Bytes(Vec<u8>),
    /// Numbers.
    Floats(Vec<f32>),
}

/// The content of a file of these fields: name, shape and values.
///
/// # Panics
/// If values do not fill a shape.
pub fn write(fields: &[(&str, Vec<usize>, Content)]) -> Vec<u8> {
    let head: usize =
        fields.iter().map(|(name, shape, _)| 2 + name.len() + 2 + 1 + 8 + 8 * shape.len()).sum();
    let mut bytes = MAGIC.to_vec();
    bytes.extend(VERSION);
    bytes.extend((fields.len() as u32).to_le_bytes());
    let mut offset = bytes.len() + head;
    let mut data = Vec::new();
    for (name, shape, content) in fields {
        let (dtype, raw) = match content {
            Content::Bytes(bytes) => (U8, bytes.clone()),
            Content::Floats(values) => (F32, values.iter().flat_map(|v| v.to_le_bytes()).collect()),
        };
        let size = TYPES[usize::from(dtype) - 1].1;
        assert_eq!(raw.len(), size * shape.iter().product::<usize>(), "`{name}` fills its shape");
        bytes.extend((name.len() as u16).to_le_bytes());
        bytes.extend(name.as_bytes());
        bytes.extend((shape.len() as u16).to_le_bytes());
        bytes.push(dtype);
        bytes.extend((offset as u64).to_le_bytes());
        bytes.extend(shape.iter().flat_map(|n| (*n as u64).to_le_bytes()));
        offset += raw.len();
        data.extend(raw);
    }
    bytes.extend(data);
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Byte by byte, as the format's reader takes it.
    #[test]
    fn bytes_are_those_of_the_format() {
        let written = write(&[
            ("ab", vec![2, 1], Content::Floats(vec![1.0, -2.5])),
            ("c", vec![3], Content::Bytes(b"xyz".to_vec())),
        ]);
        let mut expected = b"tensor_file\0\x01\x00\x02\x00\x00\x00".to_vec();
        expected.extend(b"\x02\x00ab\x02\x00\x0a");
        // Two heads of 31 and 22 bytes follow the first 18.
        expected.extend(b"\x47\0\0\0\0\0\0\0\x02\0\0\0\0\0\0\0\x01\0\0\0\0\0\0\0");
        expected.extend(b"\x01\x00c\x01\x00\x01\x4f\0\0\0\0\0\0\0\x03\0\0\0\0\0\0\0");
        // IEEE 754 single precision of 1 and −2.5.
        expected.extend(b"\x00\x00\x80\x3f\x00\x00\x20\xc0xyz");
        assert_eq!(written, expected);
        let file = TensorFile::read(&written).unwrap();
        assert_eq!(file.names(), "ab, c");
        assert_eq!(file.field("ab").unwrap().floats("", |_| true).unwrap(), [1.0, -2.5]);
        assert_eq!(file.field("ab").unwrap().shape, [2, 1]);
        assert_eq!(file.field("c").unwrap().bytes().unwrap(), b"xyz");
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let good = write(&[("ab", vec![2], Content::Floats(vec![1.0, f32::NAN]))]);
        let broken = |at: usize, byte: u8| {
            let mut bytes = good.clone();
            bytes[at] = byte;
            TensorFile::read(&bytes).unwrap_err().to_string()
        };
        for (found, parts) in [
            (broken(0, b'T'), "tensor file, byte 0: it does not begin"),
            (broken(12, 2), "byte 12: version 2.0 is not known"),
            (broken(14, 2), "byte 45: `` has the unknown type 0"),
            (broken(24, 12), "byte 24: `ab` has the unknown type 12"),
            (broken(33, 3), "`ab`, f32 of shape [3] from byte 41 on, goes beyond the end of the file at 49"),
            (broken(40, 255), "goes beyond the end"),
        ] {
            assert!(found.contains(parts), "{found}");
        }
        let file = TensorFile::read(&good).unwrap();
        let error = file.fields[0].floats("finite", f32::is_finite).unwrap_err().to_string();
        assert_eq!(error, "tensor file, byte 45: value 1 of `ab` is NaN; it must be finite");
        let error = file.fields[0].bytes().unwrap_err().to_string();
        assert!(error.contains("`ab` holds f32, where u8 belongs"), "{error}");
        for end in 0..good.len() {
            assert!(TensorFile::read(&good[..end]).is_err());
        }
    }
}
