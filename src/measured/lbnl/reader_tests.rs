//! What the reader takes and what it refuses, with the place.

use super::{Measured, ReadError, Side, Table, read, read_wavelength};
use crate::bsdf::{Direction, Subject};
use proptest::prelude::*;
use std::f64::consts::PI;

/// A file of one basis of 1 + 3 patches. Incident patch by column.
const MATRIX: &str = "<?xml version=\"1.0\"?>
<WindowElement xmlns=\"http://windows.lbl.gov\">
<FileType>BSDF</FileType>
<Optical><Layer>
<Material><Name>tiny</Name></Material>
<DataDefinition>
<IncidentDataStructure>Columns</IncidentDataStructure>
<AngleBasis><AngleBasisName>Tiny</AngleBasisName>
<AngleBasisBlock><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta><UpperTheta>30</UpperTheta></ThetaBounds></AngleBasisBlock>
<AngleBasisBlock><nPhis>3</nPhis><ThetaBounds><LowerTheta>30</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock>
</AngleBasis>
</DataDefinition>
<WavelengthData><Wavelength unit=\"Integral\">Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>Reflection Back</WavelengthDataDirection>
<ColumnAngleBasis>Tiny</ColumnAngleBasis><RowAngleBasis>Tiny</RowAngleBasis>
<ScatteringDataType>BRDF</ScatteringDataType>
<ScatteringData>
.11, .12, .13, .14,
.21, .22, .23, .24,
.31, .32, .33, .34,
.41, .42, .43, .44
</ScatteringData>
</WavelengthDataBlock></WavelengthData>
</Layer></Optical>
</WindowElement>
";

/// A tree of rank 3: a branch whose first node is a grid of 2³ values.
const TREE: &str = "<WindowElement><Optical><Layer>
<DataDefinition><IncidentDataStructure>TensorTree3</IncidentDataStructure></DataDefinition>
<WavelengthData><Wavelength>Visible</Wavelength><WavelengthDataBlock>
<WavelengthDataDirection>Transmission Front</WavelengthDataDirection>
<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>
<ScatteringData>{
{ .1 .2 .3 .4 .5 .6 .7 .8 }{.21}{.22}{.23}{.24}{.25}{.26}{.27}
}</ScatteringData>
</WavelengthDataBlock></WavelengthData>
</Layer></Optical></WindowElement>
";

fn at(theta: f64, phi: f64) -> Direction {
    Direction::from_angles(theta.to_radians(), phi.to_radians())
}

#[test]
fn columns_are_incident_and_rows_when_told() {
    let table = read(MATRIX.as_bytes()).unwrap();
    assert_eq!((&*table.name, &*table.wavelength), ("tiny", "Visible"));
    // Light from φ = 180° goes on towards 0°: patch 2. It leaves to the middle: row 1.
    assert_eq!(table.value(at(60.0, 180.0), at(10.0, 50.0)), 0.12);
    // Light from the middle to azimuth 120°: patch 3.
    assert_eq!(table.value(at(10.0, 0.0), at(80.0, 120.0)), 0.31);
    // Patch 4 is around 240°, and patch 2 reaches from −60° to 60°.
    assert_eq!(table.value(at(60.0, 61.0), at(80.0, -59.0)), 0.24);
    assert_eq!(table.value(at(60.0, 61.0), at(80.0, -61.0)), 0.44);
    let rows = read(MATRIX.replace("Columns", "Rows").as_bytes()).unwrap();
    assert_eq!(rows.value(at(60.0, 180.0), at(10.0, 50.0)), 0.21);
    // Σ f Λ: Λ of the middle is π sin² 30°, a third of the rest each.
    let (reflected, transmitted) = table.flux_from(at(60.0, 180.0));
    let exact = PI * (0.25 * 0.12 + 0.25 * (0.22 + 0.32 + 0.42));
    assert!((reflected - exact).abs() < 1e-15 && transmitted == 0.0);
}

/// Numbers of a tree's nodes and cells: the first coordinate runs slowest, and is ½ −
/// sin θ/2 of incident light.
#[test]
fn trees_are_indexed_as_radiance_does() {
    let table = read(TREE.as_bytes()).unwrap();
    // From z < 0 and θ = 60° the first coordinate is 0.067: the lower node and cell.
    // Straight on lies at azimuth 0 of the turned square, so u > ½.
    let wo = at(120.0, 40.0);
    let on = |phi: f64| table.value(wo, at(60.0, 220.0 + phi));
    // Node bit 1 is u, bit 2 is v: u > ½ and v < ½ is node 2, both node 6.
    assert_eq!((on(-20.0), on(20.0)), (0.22, 0.26));
    // u, v < ½ is node 0: sin θ 0.866 at 225° is (.067, .067), cell (0, 0, 0).
    assert_eq!(table.value(wo, at(60.0, 220.0 + 225.0)), 0.1);
    // Nearer to the middle, cell (0, 1, 1).
    assert_eq!(table.value(wo, at(20.0, 220.0 + 225.0)), 0.4);
    // From θ = 20° the first coordinate is 0.329: cell (1, 0, 0).
    assert_eq!(table.value(at(160.0, 40.0), at(60.0, 220.0 + 225.0)), 0.5);
    // sin 30° is not on an edge, whatever it is rounded to: below ¼.
    for turn in 0..50 {
        let turned = at(150.0, 40.0).rotated(f64::from(turn));
        assert_eq!(table.value(turned, at(60.0, 85.0).rotated(f64::from(turn))), 0.1);
    }
}

/// A bright sheet of every standard basis: f = 1/π everywhere is flux 1.
#[test]
fn standard_bases_cover_the_hemisphere() {
    for (name, patches) in [("LBNL/Klems Full", 145), ("LBNL/Klems Half", 77), ("LBNL/Klems Quarter", 41)] {
        let start = MATRIX.find("<AngleBasis>").unwrap();
        let end = MATRIX.find("</DataDefinition>").unwrap();
        let (first, last) = (MATRIX.find(".11").unwrap(), MATRIX.find("</ScatteringData>").unwrap());
        let values = format!("{} ", 1.0 / PI).repeat(patches * patches);
        let text = format!("{}{}{values}{}", &MATRIX[..start], &MATRIX[end..first], &MATRIX[last..]);
        let table = read(text.replace("Tiny", name).as_bytes()).unwrap();
        let fluxes = table.incident_fluxes(Side::Front);
        assert_eq!(fluxes.len(), patches);
        assert!(fluxes.iter().all(|f| (f.total() - 1.0).abs() < 1e-13));
        let asymmetry = table.asymmetry(Side::Front, Side::Front).unwrap();
        assert_eq!((asymmetry.most, asymmetry.pairs), (0.0, patches * patches));
        assert!(Measured::new(table).describe().claims.reciprocal);
    }
}

/// A file, what is replaced in it and by what, the place that is told and a part of
/// the message.
type Mistake = (&'static str, &'static str, &'static str, (u32, u32), &'static str);

#[test]
fn mistakes_are_told_with_their_place() {
    let cases: [Mistake; 27] = [
        (MATRIX, "WindowElement", "Window", (2, 1), "the root is <Window>"),
        (MATRIX, "</FileType>", "</File>", (3, 15), "well-formed"),
        (MATRIX, "<FileType>BSDF", "<FileType>Glazing", (3, 1), "a file of `Glazing`"),
        (MATRIX, ">Columns<", ">Diagonals<", (7, 1), "IncidentDataStructure `Diagonals`"),
        (MATRIX, "<nPhis>3", "<nPhis>x", (10, 18), "<nPhis> `x` is not a number"),
        (MATRIX, "<nPhis>3", "<nPhis>0", (10, 1), "a ring of 0 patches"),
        (MATRIX, "<nPhis>3", "<nPhis>18446744073709551615", (10, 1), "patches; 1 to 4095"),
        (MATRIX, "<LowerTheta>30", "<LowerTheta>31", (10, 1), "from 31° to 90° where one from 30°"),
        (MATRIX, "<UpperTheta>90", "<UpperTheta>NaN", (10, 1), "from 30° to NaN°"),
        (MATRIX, "<UpperTheta>90", "<UpperTheta>80", (10, 1), "end at 80°"),
        (MATRIX, "Name>Tiny", "Name>LBNL/Klems Full", (8, 1), "not the standard ones (4 patches"),
        (MATRIX, "Name>Tiny", "Name>Other", (15, 1), "`Tiny` is not known; there are LBNL/Klems Full"),
        (MATRIX, ">Visible<", ">Solar<", (4, 10), "no data of the wavelength `Visible`; there are `Solar`"),
        (MATRIX, "<Wavelength unit=\"Integral\">Visible</Wavelength>", "", (13, 1), "has no <Wavelength>"),
        (MATRIX, "Reflection Back", "Reflexion", (14, 1), "`Reflexion`; Transmission Front"),
        (MATRIX, ">BRDF<", ">Luminance<", (16, 1), "`Luminance`; BTDF and BRDF, in sr⁻¹"),
        (MATRIX, ".23", "-.23", (19, 11), "`-.23` is negative"),
        (MATRIX, ".23", "nan", (19, 11), "`nan` is not finite"),
        (MATRIX, ".23", "1e999", (19, 11), "`1e999` is not finite"),
        (MATRIX, ".23", "0x2", (19, 11), "`0x2` is not a number"),
        (MATRIX, ".23,", ".23,,", (19, 15), "a comma where a value is expected"),
        (MATRIX, ", .44", "", (22, 1), "15 values where 4 × 4 = 16 are needed"),
        (MATRIX, ".44", ".44 .45", (21, 20), "more values than 4 × 4 = 16"),
        (TREE, "TensorTree3", "TensorTree4", (7, 3), "a node of 8 values; 1, 16, 256"),
        (TREE, "{.27}", "", (8, 1), "a branch of 7 nodes where 8 are needed"),
        (TREE, "}</Sc", "</Sc", (8, 1), "`}` is due after 8 nodes"),
        (TREE, "LBNL/Shirley-Chiu", "LBNL/Klems Full", (5, 1), "AngleBasis `LBNL/Klems Full`"),
    ];
    for (file, from, to, place, part) in cases {
        let text = file.replace(from, to);
        assert_ne!(text, file, "{from}");
        let ReadError { line, column, message } = read(text.as_bytes()).unwrap_err();
        assert!(message.contains(part), "{from} -> {to}: {message}");
        assert_eq!((line, column), place, "{from} -> {to}: {message}");
    }
    let block = MATRIX.find("<WavelengthDataBlock>").unwrap();
    let end = MATRIX.find("</WavelengthDataBlock>").unwrap() + "</WavelengthDataBlock>".len();
    let twice = format!("{}{}{}", &MATRIX[..end], &MATRIX[block..end], &MATRIX[end..]);
    assert!(read(twice.as_bytes()).unwrap_err().message.contains("`Reflection Back` comes twice"));
    let latin = [MATRIX.as_bytes(), b"\n\xff"].concat();
    assert_eq!(read(&latin).unwrap_err().line, MATRIX.lines().count() as u32 + 2);
}

/// Deep nests, entities and other encodings are refused before they do harm.
#[test]
fn hostile_files_are_refused() {
    let place = TREE.find("{").unwrap();
    let deep = format!("{}{}{}", &TREE[..place], "{".repeat(100_000), &TREE[place..]);
    let utf16: Vec<u8> = MATRIX.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let nested = format!("{}{}", "<a>".repeat(100_000), "</a>".repeat(100_000));
    for (bytes, part) in [
        (deep.as_bytes(), "the tree is deeper than 9 levels"),
        (nested.as_bytes(), "the root is <a>"),
        (b"<!DOCTYPE x [<!ENTITY a \"b\">]><WindowElement>&a;</WindowElement>", "DTD"),
        (&utf16, "well-formed"),
        (b"\xff\xfe<", "byte 0 is not UTF-8 text"),
        (b"", "root"),
    ] {
        let message = read(bytes).unwrap_err().message;
        assert!(message.contains(part), "{message}");
    }
    let marked = [b"\xef\xbb\xbf", MATRIX.as_bytes()].concat();
    assert_eq!(read(&marked), read(MATRIX.as_bytes()));
}

/// Windows ends its lines otherwise, and texts may be parted by comments.
#[test]
fn places_are_right_whatever_ends_lines() {
    let text = MATRIX.replace(".23", "<!-- here -->-.23").replace('\n', "\r\n");
    let error = read(text.as_bytes()).unwrap_err();
    assert_eq!((error.line, error.column), (19, 24), "{error}");
    let fine = MATRIX.replace(".23", "<!-- here -->.23").replace('\n', "\r\n");
    assert_eq!(read(fine.as_bytes()), read(MATRIX.as_bytes()));
}

#[test]
fn what_is_missing_is_told() {
    let front = read(MATRIX.replace("Reflection Back", "Reflection Front").as_bytes()).unwrap();
    assert_eq!(front.value(at(10.0, 0.0), at(80.0, 120.0)), 0.31);
    assert!(front.notes[0].contains("only Reflection Front"), "{:?}", front.notes);
    let notes = read(TREE.as_bytes()).unwrap().notes.join("\n");
    for part in ["Transmission Back is missing; light from there is taken not to pass", "Reflection Front is"]
    {
        assert!(notes.contains(part), "{notes}");
    }
    let solar = MATRIX.replace(">Visible<", ">Solar<");
    assert!(read_wavelength(solar.as_bytes(), "solar").is_ok());
    // Rings of three patches have no opposite ones: the other way cannot be had.
    let odd = read(MATRIX.replace("Reflection Back", "Transmission Back").as_bytes()).unwrap();
    assert!(odd.notes[1].contains("Transmission Front is missing"), "{:?}", odd.notes);
    assert_eq!(odd.value(at(170.0, 0.0), at(10.0, 0.0)), 0.0);
}

/// A table that was read is whole: it has a block, and all that is asked of it is
/// finite.
fn assert_whole(table: Table) {
    assert!(table.has().0 || table.has().1);
    let subject = Measured::new(table);
    for wo in [at(0.0, 0.0), at(50.0, 100.0), at(89.0, 200.0), at(140.0, 300.0)] {
        for wi in [at(10.0, 20.0), at(60.0, 250.0), at(120.0, 10.0)] {
            let f = subject.table().value(wo, wi);
            assert!(f.is_finite() && f >= 0.0);
        }
        let (reflected, transmitted) = subject.table().flux_from(wo);
        assert!(reflected >= 0.0 && transmitted >= 0.0);
        assert!(subject.cells(wo).is_none_or(|c| c.cells.len() > 1));
    }
}

/// Pieces that mean something to the reader.
const PIECES: [&str; 16] = [
    "{",
    "}",
    ",",
    "<",
    ">",
    "nan",
    "-1",
    "1e308",
    "<!--",
    "<ScatteringData>",
    "&lt;",
    "TensorTree4",
    "Rows",
    "LBNL/Klems Full",
    "<AngleBasis>",
    "\u{feff}",
];

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]
    /// Cut, doubled and defaced files are refused or read whole; nothing panics.
    #[test]
    fn defaced_files_do_no_harm(
        tree in any::<bool>(),
        edits in prop::collection::vec((0u8..5, any::<prop::sample::Index>(), 0usize..40, any::<u8>()), 1..5),
    ) {
        let mut text = if tree { TREE } else { MATRIX }.as_bytes().to_vec();
        for (kind, place, length, byte) in edits {
            if text.is_empty() {
                break;
            }
            let from = place.index(text.len());
            let to = (from + length).min(text.len());
            match kind {
                0 => text[from] = byte,
                1 => { text.drain(from..to); }
                2 => { let copy = text[from..to].to_vec(); text.splice(from..from, copy); }
                3 => { text.splice(from..from, PIECES[byte as usize % PIECES.len()].bytes()); }
                _ => text.truncate(from),
            }
        }
        if let Ok(table) = read(&text) {
            assert_whole(table);
        }
    }
}
