// Holds the codes of a board's maps for the page: the board is shown anew with every look, its maps are sent once.
const FEW = 4;

export default function ({ data }) {
  const held = (window.robomillCodes ??= new Map());
  held.delete(data.rev);
  held.set(data.rev, data.codes);
  for (const rev of held.keys()) if (held.size > FEW) held.delete(rev);
  window.dispatchEvent(new Event("robomill-codes"));
}
