// Headless Chromium, driven through a pipe in its DevTools protocol, for the programs that film and measure the page.
import {spawn} from 'node:child_process';
import {mkdtempSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join, resolve} from 'node:path';

/**
 * Opens a page from a file, and waits until it has drawn or its figures stand.
 * @param before  a script that runs before those of the page
 * @returns {folder, ask(method, parameters), value(expression), close()}; the folder goes with the browser
 */
export async function openPage(page, {width, height, before}) {
  const folder = mkdtempSync(join(tmpdir(), 'pdepth_play_'));
  const browser = spawn('chromium', ['--headless', '--no-sandbox', '--disable-dev-shm-usage', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--remote-debugging-pipe', '--hide-scrollbars', '--no-first-run', `--user-data-dir=${join(folder, 'profile')}`, 'about:blank'],
    {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
  const waiting = new Map();
  let unread = Buffer.alloc(0), calls = 0, session;
  browser.stdio[4].on('data', bytes => {
    unread = Buffer.concat([unread, bytes]);
    for (let end; (end = unread.indexOf(0)) >= 0; unread = unread.subarray(end + 1)) {
      const {id, result, error} = JSON.parse(unread.subarray(0, end).toString());
      if (!waiting.has(id)) continue;
      const [go, fail] = waiting.get(id);
      waiting.delete(id);
      if (error) fail(new Error(error.message));
      else go(result);
    }
  });
  const ask = (method, params = {}) => {
    const id = ++calls;
    browser.stdio[3].write(JSON.stringify({id, method, params, sessionId: session}) + '\0');
    return new Promise((go, fail) => waiting.set(id, [go, fail]));
  };
  const value = async expression => {
    const {result, exceptionDetails} = await ask('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  const close = async () => {
    browser.kill('SIGKILL');
    await new Promise(go => browser.once('exit', go));
    rmSync(folder, {recursive: true, force: true});
  };
  try {
    const {targetId} = await ask('Target.createTarget', {url: 'about:blank'});
    ({sessionId: session} = await ask('Target.attachToTarget', {targetId, flatten: true}));
    await ask('Page.enable');
    await ask('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: false});
    await ask('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value: 'light'}]});
    await ask('Page.addScriptToEvaluateOnNewDocument', {source: before});
    await ask('Page.navigate', {url: `file://${resolve(page)}`});
    await value(`new Promise(go => { const look = () => document.getElementById('space')?.dataset.frames ? go() : setTimeout(look, 50); look(); })`);
  } catch (error) {
    await close();
    throw error;
  }
  return {folder, ask, value, close};
}
