// Worker of the operator page: reports the operator's presence and reads the station's state. A worker is not slowed down when
// the page is in the background.

const kPeriod_ms = 250;
let key = "";
let token = "";

async function report() {
  try {
    const answer = await fetch("/api/operate/state", {
      method: "POST",
      headers: { "Content-Type": "application/json", "X-Vantage-Key": key, "X-Vantage-Token": token },
      body: "{}",
      signal: AbortSignal.timeout(1000),
    });
    postMessage(answer.ok ? { state: await answer.json() } : { error: (await answer.json()).error ?? answer.statusText });
  } catch (error) {
    postMessage({ error: "the server does not answer: the vehicles hold after 1 s and land after 3 s without its heartbeat" });
  }
  setTimeout(report, kPeriod_ms);
}

onmessage = ({ data }) => {
  const is_first = key === "";
  ({ key, token } = data);
  if (is_first) report();
};
