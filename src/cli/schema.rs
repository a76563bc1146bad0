//! `schema`: what a scene may say.

use super::args::SchemaArgs;
use super::console::Console;
use super::error::Failure;
use crate::scene::{schema, schema_markdown};

pub fn run(args: &SchemaArgs, console: &Console) -> Result<(), Failure> {
    if args.markdown {
        console.line(schema_markdown().trim_end());
    } else {
        let text = serde_json::to_string_pretty(schema()).map_err(|e| Failure::Usage(e.to_string()))?;
        console.line(&text);
    }
    Ok(())
}
