// Holds the browser's key in a cookie and the tab's name in the tab, and says the name to the server.
const YEAR = 365 * 24 * 3600;
const SECURE = location.protocol === 'https:' ? '; Secure' : '';
const held = (name) => document.cookie.split('; ').find((each) => each.startsWith(name + '='))?.slice(name.length + 1) ?? '';
const hold = (name, value) => { document.cookie = `${name}=${value}; path=/; SameSite=Strict; max-age=${YEAR}${SECURE}`; };
const made = () => Array.from(crypto.getRandomValues(new Uint8Array(8)), (b) => b.toString(16).padStart(2, '0')).join('');
const kept = (value, name = 'tab') => {  // the tab's own, through reloads; the page's where the browser forbids it
  const key = `robomill.${name}`;
  try {
    if (value) sessionStorage.setItem(key, value);
    return sessionStorage.getItem(key) ?? '';
  } catch { return window[key] = value || window[key] || ''; }
};

// A doubled tab begins with the name of the one it was made of, and takes another where that one still has it: a name is
// a lock of the browser, which answers however busy the other tab is. (A page that is left lets go of it a moment late.)
const WAIT_MS = 250;
const own = (tab) => new Promise((resolve) => {
  const mine = () => { resolve(true); return new Promise(() => {}); };  // as long as the page is there
  navigator.locks.request(`robomill.tab.${tab}`, { signal: AbortSignal.timeout(WAIT_MS) }, mine).catch(() => resolve(false));
});
const alone = async () => {
  if (!navigator.locks) return asked();  // a page that is not secure
  if (!await own(kept() || kept(made()))) await own(kept(made()));
};

// Without locks it asks whether somebody has it. Of two that ask at the same moment the one with the larger lot yields.
const asked = () => new Promise((resolve) => {
  if (typeof BroadcastChannel === 'undefined') { resolve(); return; }
  const channel = new BroadcastChannel('robomill.tabs'), tab = kept(), lot = made();
  let asking = Boolean(tab);
  const done = (taken) => {
    if (!asking) return;
    asking = false;
    if (taken) kept(made());
    resolve();
  };
  channel.onmessage = ({ data }) => {
    if (data.asks === kept() && !(asking && data.lot < lot)) channel.postMessage({ has: data.asks, lot: data.lot });
    else if (data.has === tab && data.lot === lot) done(true);
  };
  if (!asking) { resolve(); return; }
  channel.postMessage({ asks: tab, lot });
  setTimeout(done, WAIT_MS, false);
});

export default function ({ data, parentElement, setStateValue }) {
  let left = false, leave = () => {};
  window.robomillAlone ??= alone();
  window.robomillAlone.then(() => { if (!left) leave = say(data, parentElement, setStateValue) ?? leave; });
  return () => { left = true; leave(); };
}

function say(data, parentElement, setStateValue) {
  let tab = kept() || made();
  if (data.moved && data.moved[0] === `tab-${tab}`) {
    tab = data.moved[1].slice(4);
    if (navigator.locks) own(tab);
  }
  kept(tab);
  let said = tab;
  if (data.key) {
    const other = held('robomill_key');
    const strange = /^[0-9a-f]{64}$/.test(other) && other !== data.key && !window.robomillMet;
    // Two tabs that met the server at the same moment: the one that comes second begins again with the first one's key.
    if (strange && kept('', 'again') !== 'once') { kept('once', 'again'); location.reload(); return; }
    if (!strange) hold('robomill_key', data.key);
    if (held('robomill_key') !== data.key) said = '';
  }
  window.robomillMet = true;
  if (parentElement.robomillSaid !== said) {
    parentElement.robomillSaid = said;
    setStateValue('tab', said);
  }
  const front = () => { if (said && document.visibilityState === 'visible') hold('robomill_tab', tab); };
  front();
  addEventListener('focus', front);
  document.addEventListener('visibilitychange', front);
  return () => { removeEventListener('focus', front); document.removeEventListener('visibilitychange', front); };
}
