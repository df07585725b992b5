// Colours as the video has them: who is who, and what has settled is paler. 0xRRGGBB.

export const css = (color) => `#${color.toString(16).padStart(6, "0")}`;

/** A colour with `share` (0 to 1) of another in it. */
export function mix(color, other, share) {
  let result = 0;
  for (const shift of [16, 8, 0]) {
    const a = (color >> shift) & 255, b = (other >> shift) & 255;
    result |= Math.round(a + (b - a) * share) << shift;
  }
  return result >>> 0;
}

export const soften = (color) => mix(color, 0x606468, 0.3);

const luminance = (color) =>
  (0.299 * ((color >> 16) & 255) + 0.587 * ((color >> 8) & 255) + 0.114 * (color & 255)) / 255;

/** The inks of the page, from the run's palette, by light or by night. */
export function inks(palette, dark) {
  if (!dark) return { ...palette, paper: 0xffffff };
  return {
    tints: palette.tints, ground: 0x24272c, outside: 0x15171a, grid: 0x2f333a,
    ink: 0xe8e6e1, soft_ink: 0xa9acb2, paper: 0x1d2024,
  };
}

export const tint = (palette, robot) => palette.tints[robot % palette.tints.length];

const coats = new Map(), MOST_COATS = 4096;   // robots may shine in any colour, one after the other

/** The colours of a body: of robot `robot`, or (null) of a thing. */
export function coat(palette, color, robot, settled) {
  const name = robot === null ? -1 : robot % palette.tints.length;
  const key = `${color},${name},${settled},${palette.ground}`;
  let found = coats.get(key);
  if (!found) {
    let fill = soften(color), rim = name < 0 ? fill : palette.tints[name];
    let edge = mix(rim, palette.ink, 0.6);
    if (settled) {
      fill = mix(fill, palette.ground, 0.6);
      edge = mix(edge, palette.ground, 0.6);
      rim = mix(rim, palette.ground, 0.45);
    }
    const halo = luminance(rim) > 0.45 ? 0x26292e : 0xffffff;
    if (coats.size >= MOST_COATS) coats.clear();
    found = { fill: css(fill), rim: css(rim), edge: css(edge), halo: css(halo) };
    coats.set(key, found);
  }
  return found;
}
