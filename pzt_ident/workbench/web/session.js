// Speaking to the server: the token of the address goes with every call, and what happens comes back as a stream.

const [token, given] = decodeURIComponent(location.hash.slice(1)).split("&");

/** The file of data that the workbench was started with. */
export const opening = given ?? "";

/** Call `/api/name`: with a body it changes something. Throws an Error with what the server said. */
export async function call(name, body, raw = false) {
  const options = { headers: { "x-pzt-token": token } };
  if (body !== undefined) Object.assign(options, { method: "POST", body: raw ? body : JSON.stringify(body) });
  let answer;
  try {
    answer = await fetch(`/api/${name}`, options);
  } catch {
    throw new Error("The workbench does not answer. Is it still running in its terminal?");
  }
  if (answer.ok) return answer;
  const said = await answer.text();
  try {
    throw new Error(JSON.parse(said).error);
  } catch (error) {
    throw error instanceof SyntaxError ? new Error(said) : error;
  }
}

export async function ask(name, body) {
  return (await call(name, body)).json();
}

/** Tell `listen` every event from now on; comes back after the server was away. */
export async function follow(listen, away) {
  for (;;) {
    try {
      const reader = (await call("events")).body.pipeThrough(new TextDecoderStream()).getReader();
      for (let text = "", part = await reader.read(); !part.done; part = await reader.read()) {
        text += part.value;
        const messages = text.split("\n\n");
        text = messages.pop();
        for (const message of messages) listen(JSON.parse(message.slice("data: ".length)));
      }
    } catch (error) {
      away(error);
    }
    await new Promise((done) => setTimeout(done, 1000));
  }
}

/** Hand a file to the browser's downloads. */
export async function save(name, as) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await (await call(name)).blob());
  link.download = as;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
