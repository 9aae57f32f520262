/* Search in pages opened from the disk. A browser starts no worker from file://, and the theme's search needs one.
 * There, and nowhere else, a hidden frame of the same page takes the worker's place: same messages, same answers. */
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(address) {
      super();
      const frame = document.createElement("iframe");
      frame.hidden = true;
      this.started = new Promise((resolve) => frame.addEventListener("load", () => resolve(frame.contentWindow)));
      const script = String(new URL(address, location)).replaceAll("&", "&amp;").replaceAll('"', "&quot;");
      frame.srcdoc = `<script>
        var answered;
        window.postMessage = (data) => answered(data);
        window.importScripts = (...addresses) => Promise.all(addresses.map((address) => new Promise((resolve) => {
          const added = document.createElement("script");
          added.src = address;
          added.onload = resolve;
          document.head.append(added);
        })));
      </` + `script><script src="${script}"></` + "script>";
      this.started.then((inside) => {
        inside.answered = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      });
      document.documentElement.append(frame);
      this.frame = frame;
    }

    postMessage(data) {
      this.started.then((inside) => inside.dispatchEvent(new inside.MessageEvent("message", { data })));
    }

    terminate() {
      this.frame.remove();
    }
  };
}
