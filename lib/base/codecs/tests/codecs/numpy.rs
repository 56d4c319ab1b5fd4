//! numpy reads what is written here, and the other way round.

use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::process::Command;

use codecs::{
    DEFAULT_LEVEL, DType, NpzReader, NpzWriter, Repeats, Scalar, encode_member, encode_records, npy_header,
};

/// Runs a Python program with the folder as its argument; `None` without Python or numpy.
fn python(program: &str, folder: &str) -> Option<String> {
    let python = testkit::python(&["numpy"])?;
    let output = Command::new(&python).args(["-c", program, folder]).output().expect("python starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(String::from_utf8(output.stdout).expect("text"))
}

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("convoy-codecs-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("a temporary folder");
        Self(path)
    }

    fn path(&self) -> &str {
        self.0.to_str().expect("UTF-8")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn numpy_reads_our_archives() {
    let folder = Folder::new("ours");
    let mut writer = NpzWriter::new(Vec::new());
    let mask: Vec<u8> = (0..24_u8).map(|i| i % 2).collect();
    let floats: Vec<u8> = (0..6_u8).flat_map(|i| f32::from(i).to_le_bytes()).collect();
    let record = DType::Record(vec![("x".into(), Scalar::F32), ("ObjTag".into(), Scalar::U32)]);
    let points: Vec<u8> = (0..3_u8)
        .flat_map(|i| [f32::from(i).to_le_bytes(), (u32::from(i) + 10).to_le_bytes()].concat())
        .collect();
    let pairs: Vec<u8> =
        (0..70_000_u32).flat_map(|i| [i.to_le_bytes(), (i / 100).to_le_bytes()].concat()).collect();
    for member in [
        encode_member("0000.npy", Scalar::Bool, &[2, 3, 4], &mask, DEFAULT_LEVEL),
        encode_member("0001.npy", Scalar::F32, &[2, 3], &floats, 0),
        encode_member("0002.npy", record, &[3], &points, DEFAULT_LEVEL),
        encode_member("0003.npy", Scalar::U8, &[0, 4], &[], DEFAULT_LEVEL),
        encode_records(
            "0004.npy",
            Scalar::U32,
            &[70_000, 2],
            &pairs,
            Repeats { distances: &[8, 800], step: 4 },
        ),
        encode_records("0005.npy", Scalar::U8, &[0, 4], &[], Repeats::NONE),
    ] {
        writer.append(member.expect("valid")).expect("in memory");
    }
    fs::write(folder.0.join("a.npz"), writer.finish().expect("in memory")).expect("written");
    let program = r#"
import sys, zipfile, numpy as np
path = sys.argv[1] + "/a.npz"
assert zipfile.ZipFile(path).testzip() is None
a = np.load(path)
assert a.files == [f"000{i}" for i in range(6)], a.files
assert a["0000"].dtype == bool and a["0000"].shape == (2, 3, 4)
assert (a["0000"].ravel() == np.arange(24) % 2).all()
assert a["0001"].dtype == np.dtype("<f4") and (a["0001"] == np.arange(6).reshape(2, 3)).all()
assert a["0002"]["ObjTag"].tolist() == [10, 11, 12] and a["0002"]["x"].tolist() == [0, 1, 2]
assert a["0003"].shape == (0, 4) and a["0005"].shape == (0, 4)
assert (a["0004"] == np.stack([np.arange(70000), np.arange(70000) // 100], 1)).all()
print("read")
"#;
    if let Some(said) = python(program, folder.path()) {
        assert_eq!(said, "read\n");
    }
}

#[test]
fn headers_are_numpys_to_the_byte() {
    let folder = Folder::new("headers");
    let shapes: [&[usize]; 9] =
        [&[], &[0], &[7], &[14, 400, 400], &[1280, 1280, 80], &[1, 1], &[123_456_789, 0], &[1; 17], &[1; 32]];
    let record: DType = DType::Record(vec![
        ("x".into(), Scalar::F32),
        ("y".into(), Scalar::F32),
        ("CosAngle".into(), Scalar::F64),
        ("ObjIdx".into(), Scalar::U32),
    ]);
    let mut ours = String::new();
    for dtype in [Scalar::Bool.into(), Scalar::U8.into(), Scalar::F16.into(), Scalar::I64.into(), record] {
        for shape in shapes {
            for byte in npy_header("test", &dtype, shape).expect("valid") {
                ours += &format!("{byte:02x}");
            }
            ours.push('\n');
        }
    }
    let program = r#"
import io, numpy as np
from numpy.lib import format
record = [("x", "<f4"), ("y", "<f4"), ("CosAngle", "<f8"), ("ObjIdx", "<u4")]
shapes = [(), (0,), (7,), (14, 400, 400), (1280, 1280, 80), (1, 1), (123456789, 0), (1,) * 17, (1,) * 32]
for dtype in [bool, "u1", "<f2", "<i8", record]:
    for shape in shapes:
        f = io.BytesIO()
        descr = format.dtype_to_descr(np.dtype(dtype))
        format.write_array_header_1_0(f, {"descr": descr, "fortran_order": False, "shape": shape})
        print(f.getvalue().hex())
"#;
    if let Some(theirs) = python(program, folder.path()) {
        assert_eq!(ours, theirs);
    }
}

#[test]
fn we_read_numpys_archives() {
    let folder = Folder::new("theirs");
    let program = r#"
import sys, numpy as np
arrays = {"a": np.arange(12, dtype="<i4").reshape(3, 4), "b": np.float64(2.5), "c": np.ones(5, bool)}
np.savez_compressed(sys.argv[1] + "/deflated.npz", **arrays)
np.savez(sys.argv[1] + "/stored.npz", **arrays)
"#;
    if python(program, folder.path()).is_none() {
        return;
    }
    for name in ["deflated.npz", "stored.npz"] {
        let bytes = fs::read(folder.0.join(name)).expect("written");
        let mut reader = NpzReader::new(Cursor::new(bytes)).expect("readable");
        assert_eq!(reader.members().collect::<Vec<_>>(), ["a.npy", "b.npy", "c.npy"]);
        let a = reader.read("a.npy").expect("readable");
        assert_eq!((a.dtype, a.shape), (Scalar::I32.into(), vec![3, 4]));
        assert_eq!(a.bytes, (0..12_i32).flat_map(i32::to_le_bytes).collect::<Vec<_>>());
        let b = reader.read("b.npy").expect("readable");
        assert_eq!((b.shape, b.bytes), (vec![], 2.5_f64.to_le_bytes().to_vec()));
        assert_eq!(reader.read("c.npy").expect("readable").bytes, [1; 5]);
    }
}

#[test]
fn python_reads_more_members_than_16_bits_count() {
    let folder = Folder::new("many");
    let mut writer = NpzWriter::new(Vec::new());
    for k in 0..65_540_u32 {
        let member = encode_member(&codecs::frame_member(k), Scalar::U32, &[1], &k.to_le_bytes(), 0);
        writer.append(member.expect("valid")).expect("in memory");
    }
    let archive = writer.finish().expect("in memory");
    let mut reader = NpzReader::new(Cursor::new(&archive)).expect("readable");
    assert_eq!(reader.members().len(), 65_540);
    assert_eq!(reader.read("65539.npy").expect("readable").bytes, 65_539_u32.to_le_bytes());
    fs::write(folder.0.join("a.npz"), &archive).expect("written");
    let program = r#"
import sys, zipfile, numpy as np
a = np.load(sys.argv[1] + "/a.npz")
print(len(a.files), a["65539"][0])
"#;
    if let Some(said) = python(program, folder.path()) {
        assert_eq!(said, "65540 65539\n");
    }
}
