// Runs a test executable of wasm32-unknown-unknown: node tests/wasm.mjs FILE. It cannot print and takes no arguments. All of
// its tests ran and passed when `main` returns 0; one that fails traps, its name in the stack trace, its message left in memory.
import { readFileSync } from 'node:fs';

Error.stackTraceLimit = 50;
const file = process.argv[2];
const { instance } = await WebAssembly.instantiate(readFileSync(file), {});
const { main, memory, panic_message } = instance.exports;
try {
    process.exitCode = main(0, 0);
    console.log(`${file}: returned ${process.exitCode}`);
} catch (trap) {
    const start = panic_message?.() ?? 0;
    if (start !== 0) {
        const bytes = new Uint8Array(memory.buffer, start);
        console.error(new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0))));
    }
    throw trap;
}
