//! Headless Chromium with an empty profile and no network.

use serde_json::Value as Json;
use std::error::Error;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// What may stand for it in the path.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
/// Longer than any page takes on a slow machine.
const PATIENCE: Duration = Duration::from_secs(180);

pub struct Chromium(&'static str);

/// Says that there is no browser; past the capture of the test harness.
pub fn skipped(name: &str) -> std::io::Result<()> {
    let names = NAMES.join(", ");
    writeln!(std::io::stdout().lock(), "SKIPPED ({name}): no browser, none of {names} runs")
}

impl Chromium {
    /// The first that runs.
    pub fn find() -> Option<Self> {
        let runs = |name: &&str| {
            let mut command = Command::new(name);
            command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
            command.status().is_ok_and(|status| status.success())
        };
        NAMES.into_iter().find(runs).map(Self)
    }

    /// Runs with the switches and an empty profile; its standard output.
    fn run(&self, name: &str, switches: &[String]) -> Result<String, Box<dyn Error>> {
        let profile = scratch(&format!("profile-{name}"));
        if profile.exists() {
            std::fs::remove_dir_all(&profile)?;
        }
        let mut command = Command::new(self.0);
        command.args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--disable-background-networking",
            "--disable-component-update",
            "--disable-sync",
            "--no-first-run",
            "--no-default-browser-check",
            "--hide-scrollbars",
            "--host-resolver-rules=MAP * ~NOTFOUND",
        ]);
        command.arg(format!("--user-data-dir={}", profile.display())).args(switches);
        command.stdout(Stdio::piped()).stderr(Stdio::null());
        let output = read(command.spawn()?)?;
        // A helper process may still write: the rest is left to the next run.
        let _ = std::fs::remove_dir_all(&profile);
        Ok(output)
    }

    /// What `probe.js` finds on a page in a window of that size.
    pub fn probe(
        &self,
        name: &str,
        html: &str,
        (width, height): (u32, u32),
    ) -> Result<Json, Box<dyn Error>> {
        let path = scratch(&format!("{name}.html"));
        let page = html.replacen("</body>", &format!("<script>{PROBE}</script></body>"), 1);
        std::fs::write(&path, page)?;
        // A window is never narrower than 500: the page lies in a frame of the width asked for.
        let frame = scratch(&format!("{name}-frame.html"));
        let style = format!("width:{width}px;height:{height}px;border:0");
        let source = format!("file://{}", path.display());
        let copy = "onload=()=>document.body.append(document.importNode(\
                    document.querySelector('iframe').contentDocument.getElementById('probe'),true))";
        let outer = format!(
            "<!DOCTYPE html><body><iframe style=\"{style}\" src=\"{source}\"></iframe>\
             <script>{copy}</script></body>"
        );
        std::fs::write(&frame, outer)?;
        let switches = [
            format!("--window-size={},{height}", width.max(500) + 40),
            "--allow-file-access-from-files".to_owned(),
            "--dump-dom".to_owned(),
            format!("file://{}", frame.display()),
        ];
        let dom = self.run(name, &switches)?;
        let start = "id=\"probe\">";
        let at = dom.rfind(start).ok_or_else(|| format!("{name}: the page was not laid out"))?;
        let json = dom[at + start.len()..].split("</script>").next().unwrap_or_default();
        Ok(serde_json::from_str(json)?)
    }

    /// The page as PDF.
    pub fn print(&self, page: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
        let pdf = scratch("report.pdf");
        let switches = [
            format!("--print-to-pdf={}", pdf.display()),
            "--no-pdf-header-footer".to_owned(),
            format!("file://{}", page.display()),
        ];
        self.run("pdf", &switches)?;
        Ok(std::fs::read(pdf)?)
    }
}

const PROBE: &str = include_str!("probe.js");

fn scratch(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("browser-{name}"))
}

/// The output of a process that ends in time; one that does not is ended.
fn read(mut child: Child) -> Result<String, Box<dyn Error>> {
    let mut pipe = child.stdout.take().ok_or("no output")?;
    let reader = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        pipe.read_to_end(&mut bytes).map(|_| bytes)
    });
    let start = Instant::now();
    while child.try_wait()?.is_none() {
        if start.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            return Err("the browser does not end".into());
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let bytes = reader.join().map_err(|_| "the reader failed")??;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
