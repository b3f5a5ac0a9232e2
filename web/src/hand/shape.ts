// The hand as the program describes it: capsules on links, with the radii of the skin.

import { HandPart, type SceneT } from '../protocol';
import { POSE_STRIDE, length, sub, toWorld, type Vec } from './vector';

/** Largest distance between skin and colliders, inwards or outwards [m]. */
export const SKIN_REACH_M = 0.42e-3;
/** Fingertips become narrower by this at their end [m]; less than SKIN_REACH_M. */
const TIP_TAPER_M = 0.35e-3;
/** Width of the shading's transition between capsules [m]: for digits, and for the palm. */
const SHADING_DIGIT_M = 4e-3;
const SHADING_PALM_M = 9e-3;
/** Ends of capsules closer than this belong to one joint [m]. */
const SAME_POINT_M = 0.6e-3;

/** A collider, and the skin's radius at either end of the same axis. */
export interface HandCapsule {
  readonly name: string;
  readonly part: HandPart;
  readonly link: number;
  readonly a: Vec;            // link frame [m]
  readonly b: Vec;
  readonly radius: number;    // of the collider [m]
  skinA: number;              // of the skin at a and at b, within SKIN_REACH_M of `radius` [m]
  skinB: number;
  readonly shading: number;   // [m]
}

export interface HandShape {
  readonly right: boolean;
  readonly capsules: readonly HandCapsule[];
  readonly palmLink: number;
  /** Links that carry capsules, parents first. */
  readonly links: readonly number[];
  /** For each link with capsules: the digit that it belongs to, or Palm. */
  readonly digitOfLink: ReadonlyMap<number, HandPart>;
  /** Links whose skin blends into the palm's: the first one of every digit, and all that rotate about its end. */
  readonly baseLinks: ReadonlySet<number>;
}

const vec = (v: { x: number; y: number; z: number } | null): Vec => v ? [v.x, v.y, v.z] : [0, 0, 0];

/** The link poses of a state in one array, see POSE_STRIDE. */
export function linkPoses(
  links: readonly { positionM: { x: number; y: number; z: number } | null;
                    orientationXyzw: { x: number; y: number; z: number; w: number } | null }[],
  into?: Float64Array): Float64Array {
  const out = into && into.length === links.length * POSE_STRIDE ? into : new Float64Array(links.length * POSE_STRIDE);
  links.forEach((pose, i) => {
    const p = pose.positionM, q = pose.orientationXyzw;
    out.set(p && q ? [p.x, p.y, p.z, q.x, q.y, q.z, q.w] : [0, 0, 0, 0, 0, 0, 1], i * POSE_STRIDE);
  });
  return out;
}

function palmLinkOf(capsules: readonly HandCapsule[]): number {
  const count = new Map<number, number>();
  for (const c of capsules) if (c.part === HandPart.Palm) count.set(c.link, (count.get(c.link) ?? 0) + 1);
  return [...count].sort((x, y) => y[1] - x[1])[0]?.[0] ?? 0;
}

/** Gives capsules of different links that share an end one common skin radius there. */
function joinRadii(capsules: HandCapsule[], poses: ArrayLike<number>): void {
  const clamp = (value: number, c: HandCapsule) =>
    Math.min(c.radius + SKIN_REACH_M, Math.max(c.radius - SKIN_REACH_M, value));
  for (const child of capsules) {
    const start = toWorld(poses, child.link, child.a);
    const parent = capsules.find((c) => c.link < child.link
      && (c.part === child.part || c.part === HandPart.Palm)
      && length(sub(toWorld(poses, c.link, c.b), start)) < SAME_POINT_M);
    if (!parent) continue;
    const shared = 0.5 * (parent.radius + child.radius);
    parent.skinB = clamp(shared, parent);
    child.skinA = clamp(shared, child);
  }
}

function taperTips(capsules: HandCapsule[]): void {
  const last = new Map<HandPart, HandCapsule>();
  for (const c of capsules) if (c.part !== HandPart.Palm) last.set(c.part, c);
  for (const c of last.values()) c.skinB = c.radius - TIP_TAPER_M;
}

/**
 * Makes the hand of a scene. @param poses any posture; it shows which capsules share a joint
 */
export function handShape(scene: Pick<SceneT, 'capsules' | 'rightHand'>, poses: ArrayLike<number>): HandShape {
  const capsules: HandCapsule[] = scene.capsules.map((c) => ({
    name: String(c.name ?? ''), part: c.part, link: c.link, a: vec(c.aM), b: vec(c.bM),
    radius: c.radiusM, skinA: c.radiusM, skinB: c.radiusM,
    shading: c.part === HandPart.Palm ? SHADING_PALM_M : SHADING_DIGIT_M,
  }));
  const palmLink = palmLinkOf(capsules);
  joinRadii(capsules, poses);
  taperTips(capsules);

  const links = [...new Set(capsules.map((c) => c.link))].sort((x, y) => x - y);
  const digitOfLink = new Map<number, HandPart>();
  for (const c of capsules) if (c.part !== HandPart.Palm) digitOfLink.set(c.link, c.part);
  for (const link of links) if (!digitOfLink.has(link)) digitOfLink.set(link, HandPart.Palm);

  const baseLinks = new Set<number>();
  const origin = (link: number) => toWorld(poses, link, [0, 0, 0]);
  for (const digit of new Set(digitOfLink.values())) {
    if (digit === HandPart.Palm) continue;
    const chain = links.filter((link) => digitOfLink.get(link) === digit);
    for (const link of chain)
      if (length(sub(origin(link), origin(chain[0]))) < SAME_POINT_M) baseLinks.add(link);
  }
  return { right: scene.rightHand, capsules, palmLink, links, digitOfLink, baseLinks };
}
