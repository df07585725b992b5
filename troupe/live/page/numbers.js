// Numbers with their units, as cards and plots write them.

/** So many digits after the point, and no minus before what is nought then. */
export const fixed = (value, digits) => value.toFixed(digits).replace(/^-(0(\.0*)?)$/, "$1");
export const metres = (value, digits = 2) => `${fixed(value, digits)} m`;
export const degrees = (radians) => `${fixed((radians * 180) / Math.PI, 1)}°`;
