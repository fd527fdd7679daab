//! Shaders: WGSL files of `shaders/`, with `#include "lib/x.wgsl"` (each file once), checked by naga before the driver sees them.
//!
//! The texts are embedded in the program; when it runs beside a checkout, the files on disk come first, so that an edited
//! shader can be reloaded. An error names the real file and line and shows the line. No strings are pasted together: what
//! varies is an `override` constant or a uniform.

use std::borrow::Cow;
use std::path::{Path, PathBuf};
use wgpu::naga;

include!(concat!(env!("OUT_DIR"), "/shaders.rs"));

/// A shader that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShaderError {
    /// No such file.
    #[error("shaders/{file}: no such shader{from}; expected a path below shaders/, such as \"lib/frame.wgsl\"")]
    Missing {
        /// The path asked for.
        file: String,
        /// Where it was asked for (` (included by …)`), or empty.
        from: String,
    },
    /// An `#include` line that cannot be read.
    #[error("shaders/{file}:{line}: `{excerpt}` is not an include; expected #include \"lib/name.wgsl\"")]
    Include {
        /// The file.
        file: String,
        /// Its line, from 1.
        line: usize,
        /// The line's text.
        excerpt: String,
    },
    /// The text is not valid WGSL.
    #[error("shaders/{file}:{line}: {message}\n    {line} | {excerpt}")]
    Invalid {
        /// The file.
        file: String,
        /// Its line, from 1.
        line: usize,
        /// The line's text.
        excerpt: String,
        /// What naga found.
        message: String,
    },
}

/// Flattened WGSL and where each of its lines came from.
#[derive(Clone, Debug)]
pub struct Source {
    /// The text with includes replaced.
    pub text: String,
    /// For every line of `text`: its file and line there, from 1.
    origin: Vec<(String, usize)>,
}

/// Where shader texts come from.
#[derive(Clone, Debug, Default)]
pub struct ShaderLibrary {
    /// A folder that is read before the embedded texts.
    pub folder: Option<PathBuf>,
}

impl ShaderLibrary {
    /// The embedded texts only.
    pub const fn embedded() -> Self {
        Self { folder: None }
    }

    /// The `shaders/` folder of the checkout this program was built in, while it is there; else the embedded texts.
    pub fn checkout() -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shaders");
        Self { folder: folder.is_dir().then_some(folder) }
    }

    /// Paths of all embedded shaders, sorted.
    pub fn names() -> impl Iterator<Item = &'static str> {
        SHADERS.iter().map(|(name, _)| *name)
    }

    fn read(&self, file: &str) -> Option<Cow<'static, str>> {
        if let Some(text) = self.folder.as_ref().and_then(|f| std::fs::read_to_string(f.join(file)).ok()) {
            return Some(Cow::Owned(text));
        }
        SHADERS.iter().find(|(name, _)| *name == file).map(|(_, text)| Cow::Borrowed(*text))
    }

    /// A file with its includes replaced.
    pub fn flatten(&self, file: &str) -> Result<Source, ShaderError> {
        let mut source = Source { text: String::new(), origin: Vec::new() };
        self.append(file, "", &mut Vec::new(), &mut source)?;
        Ok(source)
    }

    fn append(&self, file: &str, from: &str, seen: &mut Vec<String>, into: &mut Source) -> Result<(), ShaderError> {
        if seen.iter().any(|s| s == file) {
            return Ok(());
        }
        seen.push(file.to_owned());
        let text = self.read(file).ok_or_else(|| ShaderError::Missing { file: file.to_owned(), from: from.to_owned() })?;
        for (i, line) in text.lines().enumerate() {
            let Some(rest) = line.trim_start().strip_prefix("#include") else {
                into.text.push_str(line);
                into.text.push('\n');
                into.origin.push((file.to_owned(), i + 1));
                continue;
            };
            let name = rest.trim().strip_prefix('"').and_then(|r| r.strip_suffix('"')).ok_or_else(|| ShaderError::Include {
                file: file.to_owned(),
                line: i + 1,
                excerpt: line.to_owned(),
            })?;
            self.append(name, &format!(" (included by shaders/{file}:{})", i + 1), seen, into)?;
        }
        Ok(())
    }

    /// Parses and validates a file; the module and its layouts, for reflection.
    pub fn check(&self, file: &str) -> Result<(Source, naga::Module), ShaderError> {
        let source = self.flatten(file)?;
        let module = naga::front::wgsl::parse_str(&source.text)
            .map_err(|e| source.invalid(file, e.location(&source.text), e.message().to_owned()))?;
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty()).validate(&module).map_err(
            |e| {
                let mut message = e.to_string();
                let mut cause = std::error::Error::source(&e);
                while let Some(c) = cause {
                    message = format!("{message}: {c}");
                    cause = c.source();
                }
                source.invalid(file, e.location(&source.text), message)
            },
        )?;
        Ok((source, module))
    }

    /// A shader module on the device, checked first.
    pub fn load(&self, device: &wgpu::Device, file: &str) -> Result<wgpu::ShaderModule, ShaderError> {
        let (source, _) = self.check(file)?;
        Ok(device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(file),
            source: wgpu::ShaderSource::Wgsl(Cow::Owned(source.text)),
        }))
    }
}

impl Source {
    fn invalid(&self, file: &str, at: Option<naga::SourceLocation>, message: String) -> ShaderError {
        let index = at.map_or(0, |l| l.line_number.saturating_sub(1) as usize);
        let (file, line) = self.origin.get(index).cloned().unwrap_or((file.to_owned(), 1));
        let excerpt = self.text.lines().nth(index).unwrap_or_default().to_owned();
        ShaderError::Invalid { file, line, excerpt, message }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(files: &[(&str, &str)]) -> (ShaderLibrary, PathBuf) {
        let folder = std::env::temp_dir().join(format!("syzygy-shader-{}-{}", std::process::id(), files[0].0.replace('/', "-")));
        for (name, text) in files {
            let path = folder.join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        (ShaderLibrary { folder: Some(folder.clone()) }, folder)
    }

    #[test]
    fn an_error_inside_an_include_names_that_file_and_line() {
        let (lib, folder) = library(&[
            ("a.wgsl", "// head\n#include \"lib/b.wgsl\"\n#include \"lib/b.wgsl\"\nfn f() -> f32 { return one(); }\n"),
            ("lib/b.wgsl", "// head\nfn one() -> f32 {\n    return oen;\n}\n"),
        ]);
        let e = lib.check("a.wgsl").unwrap_err();
        std::fs::remove_dir_all(folder).unwrap();
        let ShaderError::Invalid { file, line, excerpt, .. } = e else { panic!("{e}") };
        assert_eq!((file.as_str(), line, excerpt.trim()), ("lib/b.wgsl", 3, "return oen;"));
    }

    #[test]
    fn a_missing_include_names_who_asked() {
        let (lib, folder) = library(&[("c.wgsl", "#include \"lib/nowhere.wgsl\"\n")]);
        let text = lib.flatten("c.wgsl").unwrap_err().to_string();
        std::fs::remove_dir_all(folder).unwrap();
        assert!(text.contains("lib/nowhere.wgsl") && text.contains("included by shaders/c.wgsl:1"), "{text}");
    }
}
