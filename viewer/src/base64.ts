// Arrays of numbers in the page: base64, little endian.

export function bytes(base64: string): Uint8Array<ArrayBuffer> {
  const text = atob(base64);
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out;
}

/** Little-endian singles; the page runs on little-endian machines alone, as browsers do. */
export function floats(base64: string): Float32Array {
  return new Float32Array(bytes(base64).buffer);
}
