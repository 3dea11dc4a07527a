// The atlas takes the place of this page once it is drawn, at the word that was asked for.

const DRAWING = 202, INTERVAL = 500; // status, ms

async function wait() {
  const { status } = await fetch("/atlas", { method: "HEAD" });
  if (status === DRAWING) return void setTimeout(wait, INTERVAL);
  location.replace(`?drawn${location.hash}`); // a reload would stay where this page is scrolled to
}

wait();
