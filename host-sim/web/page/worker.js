// Runs the tracer: one request after the other, each answered by a function of its bytes.
"use strict";
let tracer, lastSaid = "";

const textAt = (at, length) => new TextDecoder().decode(new Uint8Array(tracer.memory.buffer, at, length));

function show(at, length) {
  lastSaid = textAt(at, length);
  postMessage({ progress: lastSaid });
}

async function start(bytes) {
  const module = await WebAssembly.compile(bytes);
  const imports = { page: { show } };
  // Crates for other pages ask for functions that nothing here calls.
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    imports[from] ??= {};
    imports[from][name] ??= () => { throw new Error(`${from}.${name} is not there`); };
  }
  tracer = (await WebAssembly.instantiate(module, imports)).exports;
  postMessage({ ready: true });
}

function answer(request) {
  const at = tracer.lost_motion_buffer(request.length);
  new Uint8Array(tracer.memory.buffer, at, request.length).set(request);
  const found = tracer.lost_motion_answer(at, request.length);
  const length = new DataView(tracer.memory.buffer).getUint32(found, true);
  const text = textAt(found + 4, length);
  tracer.lost_motion_free(found, length);
  return JSON.parse(text);
}

onmessage = async ({ data }) => {
  if (data.tracer) return start(data.tracer);
  try {
    postMessage({ answer: answer(data.request) });
  } catch (error) {
    postMessage({ failed: lastSaid.startsWith("defect:") ? lastSaid : `defect: ${error.message}` });
  }
};
