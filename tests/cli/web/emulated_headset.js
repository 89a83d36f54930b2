// Runs in the page before its scripts, behind iwer: an emulated headset, whose hands are where `emulated.hands` has them, and a
// person who types with them.
window.emulated = (() => {
  const { XRDevice, metaQuest3, P_SPACE, P_JOINT_SPACE } = IWER;
  const device = new XRDevice(metaQuest3);
  device.installRuntime({ forceInstall: true });
  device.primaryInputMode = "hand";
  // It looks down at the boards, with one eye, so that a picture shows them large.
  device.position.set(0, 1.45, 0);
  device.quaternion.set(-Math.sin(0.35), 0, 0, Math.cos(0.35));
  device.fovy = 0.6;
  device.stereoEnabled = false;
  const RADII = [["wrist", 0.024], ["metacarpal", 0.018], ["proximal", 0.011], ["intermediate", 0.0095], ["distal", 0.0085], ["tip", 0.008]];
  const hands = { left: null, right: null };
  for (const side of ["left", "right"]) {
    const hand = device.hands[side];
    hand.position.set(0, 0, 0);
    hand.quaternion.set(0, 0, 0, 1);
    const names = [...hand.inputSource.hand.keys()];
    hand.updateHandPose = () => {
      if (!hands[side]) return;
      names.forEach((name, index) => {
        const joint = hand.inputSource.hand.get(name);
        const matrix = joint[P_SPACE].offsetMatrix;
        matrix.fill(0);
        matrix[0] = matrix[5] = matrix[10] = matrix[15] = 1;
        [matrix[12], matrix[13], matrix[14]] = hands[side][index];
        joint[P_JOINT_SPACE].radius = RADII.find(([part]) => name.includes(part))[1];
      });
    };
  }
  setInterval(() => {
    for (const side of ["left", "right"]) device.hands[side].connected = Boolean(hands[side]);
  }, 5);

  const FINGERS = ["thumb", "index-finger", "middle-finger", "ring-finger", "pinky-finger"];
  const JOINTS = ["metacarpal", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal", "tip"];
  const NAMES = ["wrist", ...FINGERS.flatMap((finger) =>
    JOINTS.filter((joint) => finger !== "thumb" || joint !== "phalanx-intermediate").map((joint) => `${finger}-${joint}`))];
  const modules = () => Promise.all(["/stages.js", "/headset.js", "/vectors.js"].map((it) => import(it)));

  /** Returns the 25 joints of a pose in the room. The stages do not state the metacarpals of the fingers. */
  function jointsOf(positions, toRoom) {
    const between = (name) => positions.wrist.map((axis, at) =>
      0.7 * axis + 0.3 * positions[name.replace("metacarpal", "phalanx-proximal")][at]);
    return NAMES.map((name) => toRoom(positions[name] ?? between(name)));
  }

  /** Types a text as a simulated person does, `speed` times as fast, until `isDone`. */
  async function type(text, speed, isDone = () => false) {
    const [{ loadStages }, { placement }, { move }] = await modules();
    const person = await loadStages();
    person.setLayout(document.getElementById("editor").value);
    person.type(text);
    const frames = [];
    for (let step = 0; step < 3000; step += 1) {
      const messages = person.advance(10);
      const poses = messages.filter((it) => it.kind === "pose");
      if (poses.length > 0) frames.push(poses);
      if (step > 10 && messages.find((it) => it.kind === "session").hand === "resting") break;
    }
    const start = performance.now();
    await new Promise((done) => {
      const timer = setInterval(() => {
        const index = Math.floor(((performance.now() - start) / 10) * speed);
        const own = placement();
        if (index >= frames.length || !own || isDone()) {
          clearInterval(timer);
          return done();
        }
        for (const { side, positions } of frames[index]) {
          hands[side] = jointsOf(positions, (point) => move(own.roomFromWorld, point));
        }
      }, 5);
    });
  }

  /** Returns a hand that lies flat, palm down and pointing forward, with its wrist at a point. */
  function flat([x, y, z], side) {
    const across = side === "right" ? 1 : -1;
    const finger = (index) => (joint) => [x + across * (0.02 * index - 0.04), y, z - [0.03, 0.09, 0.13, 0.155, 0.18][joint]];
    const thumb = [0.02, 0.05, 0.08, 0.1].map((along) => [x - across * (0.03 + along / 2), y, z - along]);
    return [[x, y, z], ...thumb, ...[1, 2, 3, 4].flatMap((index) => [0, 1, 2, 3, 4].map(finger(index)))];
  }

  /** Returns a hand that points forward, with the tips of thumb and index finger `apart` around a point. */
  function pinching([x, y, z], side, apart) {
    const hand = flat([x, y + 0.02, z + 0.14], side);
    hand[4] = [x - apart / 2, y, z];
    hand[9] = [x + apart / 2, y, z];
    return hand;
  }

  return { device, hands, type, flat, pinching };
})();
