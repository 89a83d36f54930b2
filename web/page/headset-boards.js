// The place of the boards in the room. The stages know the boards in a world of their own, in which the arm rests on its elbow:
// one pose, room from world, carries the boards into the room and, inverted, the joints of the hands to the stages.

import { compose, flatOf, inverse, pinchOf, poseOf, quaternionOf, unit } from "./headset-joints.js";
import { session } from "./session.js";
import { add, cross, dot, middle, move, rotate, scale, subtract } from "./vectors.js";

/** Where the boards appear: before the eyes and below them, in metres. */
const BEFORE_M = 0.42;
const BELOW_M = 0.36;

/** A pinch begins and ends at these distances between the tips of thumb and index finger, in metres. */
const PINCH_M = [0.018, 0.032];
/** A board is taken at its edge up to this distance beside its keys and above them, in metres. */
const EDGE_M = 0.055;

/** Time for which both hands lie flat to place the boards on a table, in milliseconds, and how far they may move in it. */
const TABLE_MS = 1000;
const STILL_M = 0.012;
/** The keys end this far above the table, in metres. */
const ABOVE_TABLE_M = 0.001;

export class Boards {
  constructor() {
    this.roomFromWorld = [0, 0, 0, 0, 0, 0, 1];
    this.layout = null;
    /** The hand that has taken a board, with the poses at that moment. */
    this.grip = null;
    /** The boards at whose edges hands are. */
    this.touched = new Set();
    this.pinching = { left: false, right: false };
    this.flat = null;
  }

  /** Returns the pose of a board in the room. */
  pose(index) {
    return compose(this.roomFromWorld, session.boards[index]);
  }

  /** Returns a point of the room in the world of the stages. */
  toWorld(point) {
    return move(inverse(this.roomFromWorld), point);
  }

  /** Follows the hands, and where the head is. Returns whether the boards stay, so that the hands may touch them. */
  follow(hands, head, now) {
    if (this.layout !== session.layout && session.boards.length > 0) {
      this.layout = session.layout;
      // A hand that holds a board would put the new ones at the place of the old ones.
      this.grip = null;
      this.placeBefore(head);
      return false;
    }
    const isMoved = this.#followGrip(hands);
    return !(isMoved || this.#followTable(hands, now));
  }

  /** Places the boards before the eyes. */
  placeBefore(head) {
    const looks = rotate(head, [0, 0, -1]);
    const forward = unit([looks[0], 0, looks[2]]);
    const { center, ahead: away } = shape();
    const angle = Math.atan2(away[0], away[2]) - Math.atan2(forward[0], forward[2]);
    const turn = [0, 0, 0, 0, Math.sin(-angle / 2), 0, Math.cos(angle / 2)];
    const at = add(add(head, scale(forward, BEFORE_M)), [0, -BELOW_M, 0]);
    this.#put(turn, center, at);
  }

  /** Places the boards on a table below the hands. */
  placeOnTable({ height, center: at, forward }) {
    const { center, across, away, normal, depth } = shape();
    const level = unit([forward[0], 0, forward[2]]);
    const own = [0, 0, 0, ...quaternionOf(across, away, normal)];
    const wanted = [0, 0, 0, ...quaternionOf(cross(level, [0, 1, 0]), level, [0, 1, 0])];
    this.#put(compose(wanted, inverse(own)), center, [at[0], height + depth + ABOVE_TABLE_M, at[2]]);
  }

  /** Turns the boards, so that the point `center` of the world is at `at` in the room. */
  #put(turn, center, at) {
    this.roomFromWorld = [...subtract(at, move(turn, center)), ...turn.slice(3)];
  }

  #followGrip(hands) {
    this.touched.clear();
    for (const side of ["left", "right"]) {
      const pinch = hands[side] && pinchOf(hands[side]);
      const was = this.pinching[side];
      this.pinching[side] = Boolean(pinch) && pinch.distance < PINCH_M[was ? 1 : 0];
      const board = pinch ? this.boardAt(pinch.point) : -1;
      if (board >= 0) this.touched.add(board);
      const pose = hands[side] && poseOf(hands[side]);
      if (this.pinching[side] && !was && board >= 0 && pose && !this.grip) {
        this.grip = { side, hand: pose, world: this.roomFromWorld, board };
      }
    }
    if (!this.grip) return false;
    const { side, hand, world, board } = this.grip;
    const pose = hands[side] && poseOf(hands[side]);
    if (!this.pinching[side] || !pose) {
      this.grip = null;
      return false;
    }
    this.touched.add(board);
    this.roomFromWorld = compose(compose(pose, inverse(hand)), world);
    return true;
  }

  /** Returns the index of the board at whose edge a point of the room is, beside its keys; -1 if there is none. */
  boardAt(point) {
    return (session.layout?.boards ?? []).findIndex(({ targets }, index) => {
      if (targets.length === 0 || !session.boards[index]) return false;
      const [x, y, z] = move(inverse(this.pose(index)), point);
      const low = (axis) => Math.min(...targets.map((it) => it.pose[axis] - it.half_m[axis]));
      const high = (axis) => Math.max(...targets.map((it) => it.pose[axis] + it.half_m[axis]));
      const beside = Math.max(low(0) - x, x - high(0), low(1) - y, y - high(1));
      return beside > 0 && beside < EDGE_M && Math.abs(z) < EDGE_M;
    });
  }

  #followTable(hands, now) {
    const flat = [hands.left, hands.right].map((hand) => hand && flatOf(hand));
    if (!flat.every(Boolean) || Math.abs(flat[0].height - flat[1].height) > 0.04) {
      this.flat = null;
      return false;
    }
    const centers = flat.map((it) => it.center);
    const hasMoved = this.flat && centers.some((center, index) => Math.hypot(...subtract(center, this.flat.centers[index])) > STILL_M);
    if (!this.flat || hasMoved) this.flat = { centers, since: now, isDone: false };
    if (this.flat.isDone || now - this.flat.since < TABLE_MS) return false;
    this.flat.isDone = true;
    const tip = hands.left.radii[9];
    this.placeOnTable({
      height: (flat[0].height + flat[1].height) / 2 - tip,
      center: middle(centers),
      forward: add(unit(flat[0].forward), unit(flat[1].forward)),
    });
    return true;
  }
}

/** Returns the center of all fronts in the world, the axes of the boards together, and the depth of their keys. */
function shape() {
  const boards = (session.layout?.boards ?? []).map((board, index) => ({ board, pose: session.boards[index] })).filter(({ pose }) => pose);
  const fronts = boards.flatMap(({ board, pose }) => board.targets.map((target) => move(pose, target.pose)));
  const mean = (axis) => unit(boards.reduce((sum, { pose }) => add(sum, rotate(pose, axis)), [0, 0, 0]));
  const normal = boards.length > 0 ? mean([0, 0, 1]) : [0, 1, 0];
  const upright = boards.length > 0 ? mean([0, 1, 0]) : [0, 0, -1];
  // Away from the wearer along a board that lies, and through one that stands.
  const ahead = boards.length > 0 ? mean([0, 0.8, -0.6]) : [0, 0, -1];
  const away = unit(subtract(upright, scale(normal, dot(upright, normal))));
  const low = [0, 1, 2].map((axis) => Math.min(...fronts.map((front) => front[axis])));
  const high = [0, 1, 2].map((axis) => Math.max(...fronts.map((front) => front[axis])));
  const center = fronts.length > 0 ? middle([low, high]) : [0, 0, -0.3];
  const depth = Math.max(0.004, ...boards.flatMap(({ board }) => board.targets.map((target) => target.travel_m)));
  return { center, normal, away, ahead, across: cross(away, normal), depth };
}
