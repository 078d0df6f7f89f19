//! From the XML to a [`Table`].

use super::distribution::Distribution;
use super::error::ReadError;
use super::klems::{Basis, Matrix, Ring};
use super::numbers::{Token, Tokens};
use super::table::{Side, Table};
use super::tree::Tree;
use super::xml::{child, children, optional_child, parse, same, text, wrong};
use roxmltree::Node;

/// The basis of tensor trees.
const SQUARE: &str = "LBNL/Shirley-Chiu";

/// How the values of a block are ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Structure {
    /// A row of text for each outgoing patch, a column for each incident one.
    Columns,
    /// The other way round.
    Rows,
    /// A tree of this rank.
    Tree(usize),
}

/// Reads the visible band of a file.
pub fn read(bytes: &[u8]) -> Result<Table, ReadError> {
    read_wavelength(bytes, "Visible")
}

/// Reads the band called `wavelength`, as the file's `<Wavelength>` names it:
/// `Visible`, `Solar`, `NIR`.
pub fn read_wavelength(bytes: &[u8], wavelength: &str) -> Result<Table, ReadError> {
    let document = parse(bytes)?;
    let root = document.root_element();
    if root.tag_name().name() != "WindowElement" {
        let found = root.tag_name().name();
        return Err(wrong(
            root,
            format!("the root is <{found}>; a BSDF of WINDOW starts with <WindowElement>"),
        ));
    }
    if let Some(kind) = optional_child(root, "FileType")?
        && !same(text(kind), "BSDF")
    {
        return Err(wrong(kind, format!("a file of `{}`; `BSDF` is read", text(kind))));
    }
    let layer = child(child(root, "Optical")?, "Layer")?;
    let definition = child(layer, "DataDefinition")?;
    let structure = structure(definition)?;
    let bases = children(definition, "AngleBasis").map(basis).collect::<Result<Vec<_>, _>>()?;
    let name = optional_child(layer, "Material")?.map(|m| optional_child(m, "Name")).transpose()?.flatten();
    let mut table = Table {
        name: name.map(text).unwrap_or_default().to_string(),
        wavelength: wavelength.into(),
        notes: Vec::new(),
        reflection: [None, None],
        transmission: [None, None],
    };
    let mut others: Vec<&str> = Vec::new();
    let mut found = false;
    for data in children(layer, "WavelengthData") {
        let band = child(data, "Wavelength")?;
        if !same(text(band), wavelength) {
            if !others.contains(&text(band)) {
                others.push(text(band));
            }
            continue;
        }
        for block in children(data, "WavelengthDataBlock") {
            found = true;
            read_block(&mut table, block, structure, &bases)?;
        }
    }
    if !found {
        let there = if others.is_empty() {
            "there is no <WavelengthDataBlock> at all".into()
        } else {
            format!("there are `{}`", others.join("`, `"))
        };
        return Err(wrong(layer, format!("no data of the wavelength `{wavelength}`; {there}")));
    }
    if !others.is_empty() {
        table.notes.push(format!("not read: the bands {}", others.join(", ")));
    }
    complete(&mut table);
    Ok(table)
}

fn structure(definition: Node) -> Result<Structure, ReadError> {
    let node = child(definition, "IncidentDataStructure")?;
    match text(node) {
        t if same(t, "Columns") => Ok(Structure::Columns),
        t if same(t, "Rows") => Ok(Structure::Rows),
        t if same(t, "TensorTree3") => Ok(Structure::Tree(3)),
        t if same(t, "TensorTree4") => Ok(Structure::Tree(4)),
        t => {
            let known = "Columns, Rows, TensorTree3 and TensorTree4 are read";
            Err(wrong(node, format!("IncidentDataStructure `{t}`; {known}")))
        }
    }
}

/// An angle basis that the file defines. One with a standard name must be it.
fn basis(node: Node) -> Result<Basis, ReadError> {
    let name = text(child(node, "AngleBasisName")?);
    let blocks: Vec<Node> = children(node, "AngleBasisBlock").collect();
    if blocks.is_empty() {
        return Err(wrong(node, format!("the basis `{name}` has no <AngleBasisBlock>")));
    }
    let mut rings = Vec::new();
    for block in &blocks {
        let bounds = child(*block, "ThetaBounds")?;
        rings.push(Ring {
            lower: number(child(bounds, "LowerTheta")?)?,
            upper: number(child(bounds, "UpperTheta")?)?,
            patches: number(child(*block, "nPhis")?)?,
        });
    }
    let basis =
        Basis::new(name, rings).map_err(|(k, e)| wrong(blocks[k], format!("the basis `{name}` has {e}")))?;
    if let Some(standard) = Basis::standard(name)
        && !standard.agrees_with(&basis)
    {
        let count = format!("{} patches, the standard one {}", basis.len(), standard.len());
        return Err(wrong(node, format!("the rings of `{name}` are not the standard ones ({count})")));
    }
    Ok(basis)
}

fn number<T: std::str::FromStr>(node: Node) -> Result<T, ReadError> {
    let name = node.tag_name().name();
    text(node).parse().map_err(|_| wrong(node, format!("<{name}> `{}` is not a number", text(node))))
}

fn read_block(
    table: &mut Table,
    block: Node,
    structure: Structure,
    bases: &[Basis],
) -> Result<(), ReadError> {
    let direction = child(block, "WavelengthDataDirection")?;
    let (transmission, from) = match text(direction) {
        t if same(t, "Transmission Front") => (true, Side::Back),
        t if same(t, "Transmission Back") => (true, Side::Front),
        t if same(t, "Reflection Front") => (false, Side::Back),
        t if same(t, "Reflection Back") => (false, Side::Front),
        t => {
            let known =
                "Transmission Front, Transmission Back, Reflection Front and Reflection Back are read";
            return Err(wrong(direction, format!("WavelengthDataDirection `{t}`; {known}")));
        }
    };
    if let Some(kind) = optional_child(block, "ScatteringDataType")?
        && !same(text(kind), "BTDF")
        && !same(text(kind), "BRDF")
    {
        let message = format!("ScatteringDataType `{}`; BTDF and BRDF, in sr⁻¹, are read", text(kind));
        return Err(wrong(kind, message));
    }
    let data = child(block, "ScatteringData")?;
    let mut tokens = Tokens::new(data)?;
    if tokens.peek()? == Token::End {
        return Err(wrong(data, format!("`{}` has no values", text(direction))));
    }
    let distribution = match structure {
        Structure::Tree(rank) => {
            let node = child(block, "AngleBasis")?;
            if !same(text(node), SQUARE) {
                return Err(wrong(node, format!("AngleBasis `{}`; trees are read in {SQUARE}", text(node))));
            }
            Distribution::Tree(Tree::read(rank, &mut tokens)?)
        }
        Structure::Columns | Structure::Rows => {
            let incident = named_basis(child(block, "ColumnAngleBasis")?, bases)?;
            let outgoing = named_basis(child(block, "RowAngleBasis")?, bases)?;
            Distribution::Matrix(matrix(incident, outgoing, structure, &mut tokens)?)
        }
    };
    let blocks = if transmission { &mut table.transmission } else { &mut table.reflection };
    if blocks[from as usize].is_some() {
        return Err(wrong(direction, format!("`{}` comes twice", text(direction))));
    }
    blocks[from as usize] = Some(distribution);
    Ok(())
}

fn named_basis(node: Node, bases: &[Basis]) -> Result<Basis, ReadError> {
    let name = text(node);
    let own = bases.iter().find(|b| same(&b.name, name)).cloned();
    own.or_else(|| Basis::standard(name)).ok_or_else(|| {
        let mut known: Vec<&str> = Basis::standard_names().collect();
        known.extend(bases.iter().map(|b| &*b.name).filter(|n| Basis::standard(n).is_none()));
        wrong(node, format!("the basis `{name}` is not known; there are {}", known.join(", ")))
    })
}

fn matrix(
    incident: Basis,
    outgoing: Basis,
    structure: Structure,
    tokens: &mut Tokens,
) -> Result<Matrix, ReadError> {
    let (rows, columns) = match structure {
        Structure::Rows => (incident.len(), outgoing.len()),
        _ => (outgoing.len(), incident.len()),
    };
    let mut read = Vec::new();
    loop {
        match tokens.peek()? {
            Token::Value(value) if read.len() < rows * columns => read.push(value),
            Token::Value(_) => {
                let message = format!("more values than {rows} × {columns} = {}", rows * columns);
                return Err(tokens.wrong(message));
            }
            Token::End => break,
            Token::Open | Token::Close => return Err(tokens.wrong("a brace in a matrix")),
        }
        tokens.next()?;
    }
    if read.len() < rows * columns {
        let found = read.len();
        return Err(
            tokens.wrong(format!("{found} values where {rows} × {columns} = {} are needed", rows * columns))
        );
    }
    let values = match structure {
        Structure::Rows => read,
        _ => {
            let at = |k: usize| read[(k % rows) * columns + k / rows];
            (0..rows * columns).map(at).collect()
        }
    };
    Ok(Matrix { incident, outgoing, values })
}

/// Sets what follows from what the file has, and tells what it lacks.
fn complete(table: &mut Table) {
    let [front, back] = Side::BOTH;
    if table.transmission.iter().all(Option::is_none)
        && table.reflection[front as usize].is_none()
        && table.reflection[back as usize].is_some()
    {
        table.reflection.swap(0, 1);
        let note = "only Reflection Front is there: z > 0 is that side, seen through the plane z = 0";
        table.notes.push(note.into());
    }
    for from in Side::BOTH {
        let to = from.opposite();
        if table.transmission[from as usize].is_none()
            && let Some(other) = &table.transmission[to as usize]
        {
            let missing = format!("Transmission {} is missing", from.in_window());
            let reversed = other.reversed();
            table.notes.push(match &reversed {
                Some(_) => format!("{missing}; it is taken to be the other one with light going backwards"),
                None => format!("{missing}; light from there is taken not to pass"),
            });
            table.transmission[from as usize] = reversed;
        }
        let alone = table.transmission.iter().all(Option::is_none) && from == back;
        if table.reflection[from as usize].is_none() && !alone {
            let missing = format!("Reflection {} is missing", from.in_window());
            table.notes.push(format!("{missing}; light from there is taken not to be reflected"));
        }
    }
}
