// Requests to the server, each with the token of the page's address, and the stream of its events.

const [token, dataFile] = decodeURIComponent(location.hash.slice(1)).split("&");

/** The data file that the workbench was started with. */
export const initialFile = dataFile ?? "";

/** Request `/api/name`, with a body as POST; a draft is sent even if the page is left. Throws an Error with the server's message. */
export async function request(name, body, raw = false) {
  const options = { headers: { "x-pzt-token": token } };
  if (body !== undefined) Object.assign(options, raw ? { method: "POST", body } : { method: "POST", body: JSON.stringify(body), keepalive: name === "draft" });
  let response;
  try {
    response = await fetch(`/api/${name}`, options);
  } catch {
    throw new Error("The workbench does not respond. Is it still running in its terminal?");
  }
  if (response.ok) return response;
  const message = await response.text();
  try {
    throw new Error(JSON.parse(message).error);
  } catch (error) {
    throw error instanceof SyntaxError ? new Error(message) : error;
  }
}

/** As `request`, the response as JSON. */
export async function requestJson(name, body) {
  return (await request(name, body)).json();
}

/** Call `onEvent` with every event from now on, and `onError` when the connection is lost; reconnects every second. */
export async function follow(onEvent, onError) {
  for (;;) {
    try {
      const reader = (await request("events")).body.pipeThrough(new TextDecoderStream()).getReader();
      for (let text = "", part = await reader.read(); !part.done; part = await reader.read()) {
        text += part.value;
        const messages = text.split("\n\n");
        text = messages.pop();
        for (const message of messages) onEvent(JSON.parse(message.slice("data: ".length)));
      }
    } catch (error) {
      onError(error);
    }
    await new Promise((resolve) => setTimeout(resolve, 1000));
  }
}

/** Let a button do what takes its time, and nothing more until that is done; `fail(error)` is told why it was not. */
export function once(button, work, fail) {
  button.addEventListener("click", async () => {
    if (button.getAttribute("aria-disabled") === "true") return;
    button.setAttribute("aria-disabled", "true");
    try { await work(); } catch (error) { fail(error); }
    button.setAttribute("aria-disabled", "false");
  });
}

/** Download `/api/name` as a file. */
export async function save(name, fileName) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await (await request(name)).blob());
  link.download = fileName;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
