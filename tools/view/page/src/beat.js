// The beat: words, charts and the clock are written at once, five times a second. Between beats nothing but the stage changes,
// so that nothing else has to be put together anew: of what changed the browser takes the least box around all of it.

export const kBeat_ms = 200;

const calls = [];
let count = 0;

/** Calls `write` each so many beats, with how many there were, while somebody sees the page. */
export function on_beat(write, beats = 1) {
  calls.push({ write, beats });
}

setInterval(() => {
  if (document.hidden) return;
  requestAnimationFrame(() => {
    count += 1;
    for (const { write, beats } of calls) {
      if (count % beats === 0) write(count);
    }
  });
}, kBeat_ms);
