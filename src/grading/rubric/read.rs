//! A rubric from its files, with every mistake of each at once.

use super::read_item::{Terms, read_item, seconds};
use super::terms::{Item, Language, Route, Rubric, SandboxTerms};
use crate::bsdf::Precision;
use crate::grading::ItemKind;
use crate::grading::output::{Export, Template, placeholders};
use crate::plugins::Limits;
use crate::suite::toml_reader::{Node, Reader, claims, entries, set};
use crate::suite::{FALSE_ALARM, Mistake, SEED, SuiteError, fraction, mebibytes};
use regex::Regex;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::Duration;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

const TABLES: [&str; 7] = ["rubric", "submissions", "sandbox", "language", "model", "item", "export"];

const RUBRIC_KEYS: [&str; 18] = [
    "title",
    "hidden",
    "solution",
    "seed",
    "false_alarm",
    "precision",
    "limit",
    "hints",
    "samples",
    "tolerance",
    "detect",
    "theta",
    "phi",
    "transport",
    "time_limit",
    "call_limit",
    "memory",
    "within",
];

/// What one submission may take to be measured where the rubric does not say: some minutes,
/// so that a slow one does not lose what a slow machine takes.
const LIMIT: Duration = Duration::from_secs(300);

/// Reads the rubric at `path`; its hidden part too, unless a student does.
///
/// # Errors
/// Every mistake of the file, or of its hidden part; a file that cannot be read.
pub fn load(path: &Path, with_hidden: bool) -> Result<Rubric, SuiteError> {
    let text = read_text(path).map_err(|why| {
        let help = "name a rubric; docs/grading.md has the format";
        SuiteError::new(&path.display().to_string(), "", vec![Mistake::new(0..0, why, "").help(help)])
    })?;
    let mut file = File::new(path);
    let table = parse(path, &text)?;
    file.read(table.get_ref());
    let (hidden, exports) = (file.hidden.take(), std::mem::take(&mut file.exports));
    file.rubric.hidden_path = hidden.as_ref().map(|named| file.folder.join(named.get_ref()));
    file.rubric.limits = file.terms.limits();
    file.check_whole(table.span());
    let (mut rubric, terms) = file.finish(path, &text)?;
    if let (true, Some(hidden)) = (with_hidden, &hidden) {
        read_hidden(&mut rubric, terms, hidden, (path, &text))?;
    }
    if rubric.hidden || hidden.is_none() {
        rubric.exports = exports_of(&rubric, exports)
            .map_err(|mistakes| SuiteError::new(&path.display().to_string(), &text, mistakes))?;
    }
    Ok(rubric)
}

fn read_text(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{} cannot be read: {e}", path.display()))
}

fn parse<'t>(path: &Path, text: &'t str) -> Result<Spanned<DeTable<'t>>, SuiteError> {
    DeTable::parse(text).map_err(|e| {
        let span = e.span().unwrap_or(0..0);
        let mistake = Mistake::new(span, format!("this is not TOML: {}", e.message()), "here");
        SuiteError::new(&path.display().to_string(), text, vec![mistake])
    })
}

/// The seed and items that students do not have. `within` is the rubric that names them.
fn read_hidden(
    rubric: &mut Rubric,
    terms: Terms,
    named: &Spanned<String>,
    (outer, outer_text): (&Path, &str),
) -> Result<(), SuiteError> {
    let path = rubric.folder().join(named.get_ref());
    let text = read_text(&path).map_err(|why| {
        let help = "students have no hidden part, and grade by `gonio grade --self`";
        let mistake = Mistake::new(named.span(), why, "the hidden part").help(help);
        SuiteError::new(&outer.display().to_string(), outer_text, vec![mistake])
    })?;
    let table = parse(&path, &text)?;
    let mut reader = Reader::default();
    let mut seed = None;
    for (key, span, value) in entries(table.get_ref()) {
        match (key, value.get_ref()) {
            ("seed", _) => seed = reader.seed(key, value),
            ("item", DeValue::Array(list)) => {
                for node in list.iter() {
                    if let Some(item) = read_item(&mut reader, node, &terms, &rubric.items) {
                        rubric.items.push(Item { hidden: true, ..item });
                    }
                }
            }
            ("item", _) => reader.refuse(key, value, "tables: [[item]]"),
            _ => reader.unknown(span, "key of a hidden part", key, &["seed", "item"]),
        }
    }
    match seed {
        Some(seed) if seed == rubric.seed => {
            let help = "choose another: students can run the public one";
            reader.note(Mistake::new(0..0, "the hidden seed is the public one", "here").help(help));
        }
        Some(seed) => rubric.seed = seed,
        None if reader.mistakes.is_empty() => {
            let help = "add seed = N, which students do not know";
            reader.note(Mistake::new(0..0, "a hidden part without `seed`", "here").help(help));
        }
        None => {}
    }
    check_models(&mut reader, &rubric.models, rubric.items.iter().filter(|i| i.hidden));
    rubric.hidden = true;
    if reader.mistakes.is_empty() {
        Ok(())
    } else {
        Err(SuiteError::new(&path.display().to_string(), &text, reader.mistakes))
    }
}

/// A rubric while it is read.
struct File {
    reader: Reader,
    rubric: Rubric,
    terms: Terms,
    hidden: Option<Spanned<String>>,
    exports: Vec<Columns>,
    folder: PathBuf,
}

impl File {
    fn new(path: &Path) -> Self {
        let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let rubric = Rubric {
            path: path.into(),
            title,
            solution: None,
            seed: SEED,
            hidden: false,
            hidden_path: None,
            false_alarm: FALSE_ALARM,
            precision: Precision::F64,
            limit: LIMIT,
            pattern: Regex::new("").expect("it is one"),
            id: None,
            sandbox: SandboxTerms::default(),
            limits: Limits::default(),
            languages: Vec::new(),
            models: BTreeMap::new(),
            items: Vec::new(),
            exports: Vec::new(),
        };
        let folder = path.parent().unwrap_or(Path::new("")).into();
        Self {
            reader: Reader::default(),
            rubric,
            terms: Terms::default(),
            hidden: None,
            exports: Vec::new(),
            folder,
        }
    }

    fn read(&mut self, table: &DeTable) {
        // Items take what [rubric] says, wherever it stands.
        if let Some(DeValue::Table(table)) = table.get("rubric").map(Spanned::get_ref) {
            self.read_rubric(table);
        }
        for (key, span, value) in entries(table) {
            match (key, value.get_ref()) {
                ("rubric", DeValue::Table(_)) => {}
                ("submissions", DeValue::Table(table)) => self.read_submissions(table),
                ("sandbox", DeValue::Table(table)) => self.read_sandbox(table),
                ("model", DeValue::Table(table)) => self.read_models(table),
                ("language", DeValue::Array(list)) => list.iter().for_each(|node| self.read_language(node)),
                ("item", DeValue::Array(list)) => {
                    for node in list.iter() {
                        let found = read_item(&mut self.reader, node, &self.terms, &self.rubric.items);
                        self.rubric.items.extend(found);
                    }
                }
                ("export", DeValue::Array(list)) => list.iter().for_each(|node| self.read_export(node)),
                ("language" | "item" | "export", _) => {
                    self.reader.refuse(key, value, &format!("tables: [[{key}]]"));
                }
                ("rubric" | "submissions" | "sandbox" | "model", _) => {
                    self.reader.refuse(key, value, &format!("a table: [{key}]"));
                }
                _ => self.reader.unknown(span, "table of a rubric", key, &TABLES),
            }
        }
    }

    fn read_rubric(&mut self, table: &DeTable) {
        let reader = &mut self.reader;
        for (key, span, value) in entries(table) {
            match key {
                "title" => set(&mut self.rubric.title, text(reader, key, value)),
                "hidden" => self.hidden = reader.text(key, value),
                "solution" => self.rubric.solution = text(reader, key, value).map(|t| self.folder.join(t)),
                "seed" => set(&mut self.rubric.seed, reader.seed(key, value)),
                "false_alarm" => set(&mut self.rubric.false_alarm, reader.number(key, value, fraction)),
                "precision" => {
                    let word = reader.word(key, value, &["f64", "f32"]);
                    let precision = |w| if w == "f32" { Precision::F32 } else { Precision::F64 };
                    set(&mut self.rubric.precision, word.map(precision));
                }
                "limit" => set(&mut self.rubric.limit, seconds(reader, key, value)),
                _ if self.terms.read(reader, key, value) => {}
                _ => reader.unknown(span, "key of [rubric]", key, &RUBRIC_KEYS),
            }
        }
    }

    fn read_submissions(&mut self, table: &DeTable) {
        let reader = &mut self.reader;
        let mut id = None;
        for (key, span, value) in entries(table) {
            match key {
                "pattern" => {
                    let Some(text) = reader.text(key, value) else { continue };
                    // The whole name, not a part of it.
                    match Regex::new(&format!("^(?:{})$", text.get_ref())) {
                        Ok(pattern) => self.rubric.pattern = pattern,
                        Err(e) => {
                            let what = e.to_string();
                            let what = what.lines().last().unwrap_or_default().trim();
                            let message = format!("`pattern` is no regular expression: {what}");
                            reader.note(Mistake::new(text.span(), message, "here"));
                        }
                    }
                }
                "id" => id = reader.text(key, value),
                _ => reader.unknown(span, "key of [submissions]", key, &["pattern", "id"]),
            }
        }
        if let Some(id) = id {
            let known: Vec<String> =
                self.rubric.pattern.capture_names().flatten().map(String::from).collect();
            match Template::parse(id.get_ref(), &known) {
                Ok(template) => self.rubric.id = Some(template),
                Err(why) => self.reader.note(Mistake::new(id.span(), why, "here")),
            }
        }
    }

    fn read_sandbox(&mut self, table: &DeTable) {
        let reader = &mut self.reader;
        let terms = &mut self.rubric.sandbox;
        let bytes = |mib: f64| (mib as u64) << 20;
        for (key, span, value) in entries(table) {
            match key {
                "build_time" => set(&mut terms.build_time, seconds(reader, key, value)),
                "processes" => set(&mut terms.processes, reader.number(key, value, whole).map(|n| n as u64)),
                "disk" => set(&mut terms.disk, reader.number(key, value, mebibytes).map(bytes)),
                "output" => set(&mut terms.output, reader.number(key, value, whole).map(bytes)),
                "read" => {
                    // An empty list says what the default does.
                    if value.get_ref().as_array().is_some_and(|list| list.is_empty()) {
                        continue;
                    }
                    for item in reader.items(key, value).unwrap_or_default() {
                        if let Some(text) = reader.text(key, item) {
                            terms.read.push(self.folder.join(home(text.get_ref())));
                        }
                    }
                }
                _ => {
                    let known = ["build_time", "processes", "disk", "output", "read"];
                    reader.unknown(span, "key of [sandbox]", key, &known);
                }
            }
        }
    }

    fn read_models(&mut self, table: &DeTable) {
        for (name, _, value) in entries(table) {
            let DeValue::Table(table) = value.get_ref() else {
                self.reader.refuse(name, value, &format!("a table: [model.{name}]"));
                continue;
            };
            let mut held = Default::default();
            for (key, span, value) in entries(table) {
                match key {
                    "claims" => held = claims(&mut self.reader, value),
                    _ => self.reader.unknown(span, "key of a [model]", key, &["claims"]),
                }
            }
            self.rubric.models.insert(name.into(), held);
        }
    }

    fn read_language(&mut self, node: &Node) {
        let DeValue::Table(table) = node.get_ref() else {
            return self.reader.refuse("language", node, "tables: [[language]]");
        };
        let reader = &mut self.reader;
        let (mut name, mut when, mut build) = (None, None, None);
        let mut files = Vec::new();
        let mut routes = Vec::new();
        for (key, span, value) in entries(table) {
            match key {
                "name" => name = text(reader, key, value),
                "when" => when = inside(reader, key, value),
                "build" => build = text(reader, key, value),
                "files" => {
                    for item in reader.items(key, value).unwrap_or_default() {
                        let Some(text) = reader.text(key, item) else { continue };
                        let path = self.folder.join(text.get_ref());
                        if !path.exists() {
                            let message = format!("`{}` does not exist", path.display());
                            let help = "paths are relative to the folder of the rubric";
                            reader.note(Mistake::new(text.span(), message, "this file").help(help));
                        }
                        files.push(path);
                    }
                }
                "wasm" => routes.extend(inside(reader, key, value).map(Route::Wasm)),
                "library" => routes.extend(inside(reader, key, value).map(Route::Library)),
                "process" => {
                    let items = reader.items(key, value).unwrap_or_default();
                    let words: Vec<String> = items.iter().filter_map(|i| text(reader, key, i)).collect();
                    routes.push(Route::Process(words));
                }
                _ => {
                    let known = ["name", "when", "files", "build", "wasm", "library", "process"];
                    reader.unknown(span, "key of a [[language]]", key, &known);
                }
            }
        }
        if reader.mistakes.is_empty() && routes.len() != 1 {
            let message = "a [[language]] says in one way what is measured";
            let help = "write wasm = \"FILE\", library = \"FILE\" or process = [\"COMMAND\", …]";
            reader.note(Mistake::new(node.span(), message, "here").help(help));
        }
        let Some(when) = when else {
            let message = "a [[language]] without `when`";
            let help = "name the file that tells it: when = \"brdf.cpp\"";
            return reader.note(Mistake::new(node.span(), message, "here").help(help));
        };
        if let Some(route) = routes.pop() {
            let name = name.unwrap_or_else(|| when.clone());
            self.rubric.languages.push(Language { name, when, files, build, route });
        }
    }

    fn read_export(&mut self, node: &Node) {
        let DeValue::Table(table) = node.get_ref() else {
            return self.reader.refuse("export", node, "tables: [[export]]");
        };
        let reader = &mut self.reader;
        let (mut file, mut columns) = (None, Vec::new());
        for (key, span, value) in entries(table) {
            match (key, value.get_ref()) {
                ("file", _) => file = reader.text(key, value),
                ("columns", DeValue::Table(table)) => {
                    for (name, _, value) in entries(table) {
                        // A column may be empty.
                        if value.get_ref().as_str() == Some("") {
                            columns.push((name.into(), String::new()));
                        } else if let Some(template) = reader.text(name, value) {
                            columns.push((name.into(), template.into_inner()));
                        }
                    }
                }
                ("columns", _) => reader.refuse(key, value, "a table as { Grade = \"{score}\" }"),
                _ => reader.unknown(span, "key of an [[export]]", key, &["file", "columns"]),
            }
        }
        match file {
            Some(file) if !columns.is_empty() => self.exports.push((file, columns)),
            _ if !reader.mistakes.is_empty() => {}
            _ => {
                let message = "an [[export]] has a `file` and `columns`";
                let help = "write file = \"moodle.csv\" and columns = { Grade = \"{score}\" }";
                reader.note(Mistake::new(node.span(), message, "here").help(help));
            }
        }
    }

    fn check_whole(&mut self, span: Range<usize>) {
        check_models(&mut self.reader, &self.rubric.models, self.rubric.items.iter());
        let lacks = |what: &str, help: &str| {
            Mistake::new(span.clone(), format!("a rubric without {what}"), "here").help(help)
        };
        let mut missing = Vec::new();
        if self.rubric.items.is_empty() {
            missing.push(lacks("[[item]]", "add what earns points; docs/grading.md has an example"));
        }
        if self.rubric.languages.is_empty() {
            missing.push(lacks(
                "[[language]]",
                "say how submissions are told and built; docs/grading.md has examples",
            ));
        }
        let compares = |item: &Item| item.reference.as_deref() == Some("solution");
        if self.rubric.solution.is_none() && self.rubric.items.iter().any(compares) {
            missing
                .push(lacks("`solution`", "an item compares with it: add solution = \"FOLDER\" to [rubric]"));
        }
        if self.rubric.items.iter().all(|item| item.kind != ItemKind::Regular)
            && !self.rubric.items.is_empty()
        {
            missing.push(lacks(
                "points",
                "no item counts towards a maximum: one at least is neither bonus nor penalty",
            ));
        }
        // What is missing may be what was not understood.
        if self.reader.mistakes.is_empty() {
            missing.into_iter().for_each(|mistake| self.reader.note(mistake));
        }
    }

    fn finish(self, path: &Path, text: &str) -> Result<(Rubric, Terms), SuiteError> {
        if self.reader.mistakes.is_empty() {
            Ok((self.rubric, self.terms))
        } else {
            Err(SuiteError::new(&path.display().to_string(), text, self.reader.mistakes))
        }
    }
}

/// Every subject of an item is one of the models that a submission must offer.
fn check_models<'i>(
    reader: &mut Reader,
    models: &BTreeMap<String, crate::bsdf::ClaimsPatch>,
    items: impl Iterator<Item = &'i Item>,
) {
    let mut told = BTreeSet::new();
    for subject in items.flat_map(|item| &item.subjects) {
        let name = subject.split(':').next().unwrap_or_default();
        if !models.contains_key(name) && told.insert(name.to_string()) {
            let message = format!("`{name}` is measured, and is no [model] of the rubric");
            let help = format!("add [model.{name}], with the claims that it is held to");
            reader.note(Mistake::new(0..0, message, "here").help(help));
        }
    }
}

/// An export as it is written: its file, and columns with their templates.
type Columns = (Spanned<String>, Vec<(String, String)>);

/// Exports, which may name every item.
fn exports_of(rubric: &Rubric, written: Vec<Columns>) -> Result<Vec<Export>, Vec<Mistake>> {
    let groups = rubric.pattern.capture_names().flatten();
    let known = placeholders(rubric.items.iter().map(|item| item.id.as_str()), groups);
    let (mut exports, mut mistakes) = (Vec::new(), Vec::new());
    for (file, columns) in written {
        let columns = columns.iter().map(|(name, template)| (name.as_str(), template.as_str()));
        match Export::new(file.get_ref(), columns, &known) {
            Ok(export) => exports.push(export),
            Err(why) => mistakes.push(Mistake::new(file.span(), why, "this table")),
        }
    }
    if mistakes.is_empty() { Ok(exports) } else { Err(mistakes) }
}

/// A path that stays in the folder that it is of.
fn inside(reader: &mut Reader, key: &str, value: &Node) -> Option<String> {
    let text = reader.text(key, value)?;
    let is_plain = |c: std::path::Component| matches!(c, std::path::Component::Normal(_));
    if !Path::new(text.get_ref()).components().all(is_plain) {
        let message = format!("`{key}` names a file in its own folder, not `{}`", text.get_ref());
        reader.note(Mistake::new(text.span(), message, "leads elsewhere"));
        return None;
    }
    Some(text.into_inner())
}

fn text(reader: &mut Reader, key: &str, value: &Node) -> Option<String> {
    reader.text(key, value).map(Spanned::into_inner)
}

fn whole(n: f64) -> Result<f64, String> {
    if n >= 1.0 && n.fract() == 0.0 && n <= 1e6 {
        Ok(n)
    } else {
        Err(format!("{n} is no whole number from 1 to 10^6"))
    }
}

/// `~` is the home folder.
fn home(path: &str) -> PathBuf {
    match (path.strip_prefix("~/"), std::env::var_os("HOME")) {
        (Some(rest), Some(home)) => Path::new(&home).join(rest),
        _ => path.into(),
    }
}
