// Models of the devices of shipped tasks, made to the sizes of their bodies, and what they show of the task's progress: powder in a
// mill's drawer, juice in a glass. The touched parts have the sizes of their shapes. The program's frame, z up.
import { Color, CylinderGeometry, ExtrudeGeometry, Group, InstancedMesh, LatheGeometry, Matrix4, Mesh, Path, PlaneGeometry, Quaternion, Shape, SphereGeometry, Vector2, Vector3, type BufferGeometry, type Material, type Object3D } from 'three';
import { ShapeType, type BodyT, type ShapeT } from '../../protocol';
import { surface } from '../../scene/materials';
import { numbers, picture, type Pen } from '../../scene/textures';
import { colorOf, type Size, type Workshop } from './furniture';

export interface Appliance {
  /** Model of a body in its own frame; undefined: it is drawn by its shapes. */
  model(body: BodyT): Group | undefined;
  /** @param done share of the task's way, 0 .. 1 @param q coordinate of the joint, relative to its range */
  show(done: number, q: number): void;
}

type Outline = readonly (readonly [radius_m: number, z_m: number])[];
type Models = Readonly<Record<string, (body: BodyT) => Group>>;

const shapeOf = (body: BodyT, type: ShapeType): ShapeT => body.shapes.find((shape) => shape.type === type)!;
const sizeOf = ({ halfExtentsM: h }: ShapeT): Size => [2 * h!.x, 2 * h!.y, 2 * h!.z];
const placeOf = ({ inBody }: ShapeT): Size => { const p = inBody!.positionM!; return [p.x, p.y, p.z]; };

function at<O extends Object3D>(object: O, x: number, y: number, z: number): O {
  object.position.set(x, y, z);
  return object;
}

function shaded(geometry: BufferGeometry, material: Material): Mesh {
  const mesh = new Mesh(geometry, material);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

const turned = (outline: Outline, material: Material, { quality }: Workshop): Mesh =>
  shaded(new LatheGeometry(outline.map(([r, z]) => new Vector2(r, z)), quality === 'high' ? 48 : 24).rotateX(Math.PI / 2), material);

const bar = (shop: Workshop, radius_m: number, length_m: number, material: Material, x: number, y: number, z: number): Mesh => at(shop.bar(radius_m, length_m, material), x, y, z);

/** A rectangle with round corners. @param near_m radius of the corners at low x */
function rounded<P extends Path>(path: P, x0: number, x1: number, half_y: number, far_m: number, near_m = far_m): P {
  path.moveTo(x0 + near_m, -half_y).lineTo(x1 - far_m, -half_y);
  path.absarc(x1 - far_m, -half_y + far_m, far_m, -Math.PI / 2, 0, false);
  path.absarc(x1 - far_m, half_y - far_m, far_m, 0, Math.PI / 2, false);
  path.absarc(x0 + near_m, half_y - near_m, near_m, Math.PI / 2, Math.PI, false);
  path.absarc(x0 + near_m, -half_y + near_m, near_m, Math.PI, 1.5 * Math.PI, false);
  return path;
}

/** A prism over a rectangle with round corners; hollow with a wall, if one is given. */
function prism([x, y, z]: Size, round_m: number, material: Material, wall_m = 0): Mesh {
  const outline = rounded(new Shape(), -x / 2, x / 2, y / 2, round_m);
  if (wall_m > 0) outline.holes.push(rounded(new Path(), -x / 2 + wall_m, x / 2 - wall_m, y / 2 - wall_m, Math.max(1e-4, round_m - wall_m)));
  return shaded(new ExtrudeGeometry(outline, { depth: z, bevelEnabled: false, curveSegments: 6 }).translate(0, 0, -z / 2), material);
}

/** A mill whose beans go down and whose powder fills a drawer. */
function coffeeMill(shop: Workshop): Appliance {
  const beans = new Group(), powder = new Group(), coffee = surface(shop.quality, { color: new Color('#4a2b18'), roughness: 0.9 });
  const brass = surface(shop.quality, { color: new Color('#c99a45'), metalness: shop.quality === 'high' ? 0.7 : 0, roughness: 0.32, envMapIntensity: 1.3 });
  const models: Models = {
    mill(body) {
      const root = new Group(), [x, y, z] = sizeOf(shapeOf(body, ShapeType.Box)), top = z / 2, dark = shop.wood('#5a3a26'), wood = shop.wood('#a0683f');
      root.add(shop.board([1.1 * x, 1.1 * y, 0.014], [0, 0, 0.007 - top], dark), shop.board([0.92 * x, 0.92 * y, z - 0.022], [0, 0, 0.002], wood), shop.board([1.04 * x, 1.04 * y, 0.01], [0, 0, top - 0.005], dark));
      root.add(turned([[1e-4, 0.001], [0.03, 0.001], [0.047, 0.009], [0.049, 0.011], [0.045, 0.011], [0.028, 0.003], [1e-4, 0.003]].map(([r, up]) => [r!, top + up!] as const), brass, shop));
      beans.add(scattered(90, 0.041, coffee));
      root.add(at(beans, 0, 0, top + 0.005), at(drawer(y), -0.46 * x, 0, -0.02));
      return root;
    },
    crank(body) {
      const root = new Group(), peg = shapeOf(body, ShapeType.Cylinder), arm = shapeOf(body, ShapeType.Box), [px, py, pz] = placeOf(peg), [ax, ay, az] = placeOf(arm);
      const r = peg.radiusM, half = peg.lengthM / 2, axle = 2 * ax - px, [long, , thick] = sizeOf(arm);
      root.add(shop.board([long, 0.015, 0.8 * thick], [ax, ay, az], brass, 0.004), bar(shop, 0.011, 0.012, brass, axle, ay, az + 0.008), bar(shop, 0.005, 0.03, brass, axle, ay, az - 0.012));
      root.add(at(turned([[1e-4, -half], [0.7 * r, -half], [0.75 * r, 0.012 - half], [r, 0.035 - half], [r, 0], [0.93 * r, 0.4 * half], [r, 0.8 * half], [0.8 * r, half - 0.003], [1e-4, half]], shop.paint('#7a2f24'), shop), px, py, pz));
      root.add(at(turned([[0.8 * r, -half], [0.82 * r, 0.01 - half]], brass, shop), px, py, pz));
      return root;
    },
  };
  /** A drawer that stands open towards the person. */
  function drawer(y: number): Group {
    const root = new Group(), wide = 0.6 * y, tall = 0.034, out = 0.044, wood = shop.wood('#8a5836'), heap = turned([[0.024, 0], [0.02, 0.008], [0.011, 0.017], [1e-4, 0.021]], coffee, shop);
    root.add(shop.board([0.007, wide + 0.012, tall + 0.008], [-out, 0, 0], shop.wood('#b97f50'), 0.003), shop.board([out, wide, 0.003], [-out / 2, 0, -tall / 2], wood, 0.001));
    for (const side of [-1, 1]) root.add(shop.board([out, 0.003, 0.75 * tall], [-out / 2, side * wide / 2, -tall / 8], wood, 0.001));
    root.add(shop.board([0.004, wide, tall], [0.001, 0, 0], coffee, 0.001), shaded(new SphereGeometry(0.007, 16, 12).translate(-out - 0.008, 0, 0), brass));
    powder.add(heap);
    root.add(at(powder, -out / 2, 0, 0.002 - tall / 2));
    return root;
  }
  return {
    model: (body) => models[String(body.name)]?.(body),
    show(done) {
      powder.visible = done > 0;
      powder.scale.set(0.5 + 0.5 * done, 0.6 + 0.6 * done, Math.max(1e-3, done) * 1.25);
      beans.position.z = beans.userData.top_z ??= beans.position.z;
      beans.position.z -= 0.006 * done;
    },
  };
}

/** Beans that lie on a disc, in one drawing call. */
function scattered(count: number, radius_m: number, material: Material): InstancedMesh {
  const random = numbers(17), mesh = new InstancedMesh(new SphereGeometry(0.0042, 8, 6), material, count), place = new Matrix4();
  for (let i = 0; i < count; i++) {
    const a = 2.4 * i, r = radius_m * Math.sqrt((i + 0.5) / count), turn = new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), 6.28 * random());
    mesh.setMatrixAt(i, place.compose(new Vector3(r * Math.cos(a), r * Math.sin(a), 0.002 * random() + 0.003 * r / radius_m), turn, new Vector3(1.35, 0.9, 0.65)));
  }
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

/** A citrus press: a lemon between its jaws, and a glass that fills. @param side +1: the free side is left */
function pressLever(shop: Workshop, side: number): Appliance {
  const juice = new Group(), stream = new Group(), lemon = new Group();
  const enamel = shop.paint('#3f7f86'), cream = shop.paint('#f3e8d2'), yellow = surface(shop.quality, { color: new Color('#f2c52e'), roughness: 0.5 });
  const glass = surface(shop.quality, { color: new Color('#e8f4f4'), transparent: true, opacity: 0.34, roughness: 0.08, depthWrite: false, side: 2 });
  const lemonade = surface(shop.quality, { color: new Color('#f6d24a'), transparent: true, opacity: 0.9, roughness: 0.2 });
  const models: Models = {
    stand(body) {
      const root = new Group(), [x, y, z] = sizeOf(shapeOf(body, ShapeType.Box)), top = z / 2, low = -z / 2, [jaw_x, jaw_y] = [0.027, -0.026 * side];
      root.add(shop.board([x, y, 0.018], [0, 0, low + 0.009], enamel, 0.008), shop.board([0.86 * x, 0.8 * y, z - 0.016], [0, 0, low + z / 2], enamel, 0.014), shop.board([0.8 * x, 0.72 * y, 0.006], [0, 0, top - 0.002], cream, 0.003));
      root.add(shop.board([0.09, 0.006, 0.05], [jaw_x + 0.005, jaw_y, top + 0.023], cream, 0.003));
      // A lemon with its tip, between the jaws.
      lemon.add(shaded(new SphereGeometry(0.024, 24, 16).scale(1.2, 0.6, 1), yellow), shaded(new SphereGeometry(0.006, 12, 10).translate(-0.028, 0, 0), yellow));
      root.add(at(lemon, jaw_x, jaw_y + 0.016 * side, top + 0.03));
      const spout = bar(shop, 0.007, 0.05, shop.metal, -0.035, side * (y / 2 + 0.002), top - 0.012), cup_y = side * (y / 2 + 0.035);
      spout.rotation.x = -side * 1.9;
      root.add(spout, at(turned([[1e-4, 0.002], [0.022, 0.002], [0.027, 0.044], [0.0255, 0.044], [0.021, 0.004], [1e-4, 0.004]], glass, shop), -0.035, cup_y, low));
      juice.add(shaded(new CylinderGeometry(0.0245, 0.0205, 0.036, 24).rotateX(Math.PI / 2).translate(0, 0, 0.018), lemonade));
      stream.add(bar(shop, 0.0022, 0.034, lemonade, 0, -0.008 * side, 0.03));
      root.add(at(juice, -0.035, cup_y, low + 0.004), at(stream, -0.035, cup_y, low));
      return root;
    },
    post(body) {
      const root = new Group(), { radiusM: r, lengthM: l } = shapeOf(body, ShapeType.Cylinder);
      root.add(shop.bar(r, l, shop.metal), bar(shop, 1.6 * r, 0.012, enamel, 0, 0, 0.006 - l / 2));
      return root;
    },
    lever(body) {
      const root = new Group(), grip = shapeOf(body, ShapeType.Cylinder), arm = shapeOf(body, ShapeType.Box), [gx, gy, gz] = placeOf(grip), [ax, ay, az] = placeOf(arm), [long, , thick] = sizeOf(arm), end = ax + long / 2;
      root.add(bar(shop, grip.radiusM, grip.lengthM, shop.paint('#b8442f'), gx, gy, gz), bar(shop, 1.25 * grip.radiusM, 0.012, shop.metal, gx, gy, gz - grip.lengthM / 2 - 0.004));
      root.add(shop.board([long, 0.013, thick], [ax, ay, az], shop.metal, 0.003), shop.board([0.06, 0.005, 0.018], [end - 0.038, ay - 0.008 * side, az + 0.011], cream, 0.002), bar(shop, 0.009, 0.03, shop.metal, end - 0.008, ay, az));
      return root;
    },
  };
  return {
    model: (body) => models[String(body.name)]?.(body),
    show(done, q) {
      juice.visible = done > 0;
      juice.scale.z = Math.max(1e-3, done);
      stream.visible = q > 0.5 && done < 1;
      lemon.scale.y = 1 - 0.3 * Math.max(0, Math.min(1, q));
    },
  };
}

/** A tin of biscuits. */
function biscuitTin(shop: Workshop): Appliance {
  const models: Models = {
    box(body) {
      const root = new Group(), [x, y, z] = sizeOf(shapeOf(body, ShapeType.Box)), top = z / 2, tin = shop.paint(colorOf(body)), band = shop.paint('#a8402c'), baked = shop.wood('#d9a45c'), hinge = bar(shop, 0.004, 0.6 * y, shop.metal, x / 2, 0, top);
      root.add(prism([x, y, z], 0.01, tin, 0.002), at(prism([x - 0.003, y - 0.003, 0.004], 0.009, shop.metal), 0, 0, 0.002 - top));
      for (const [up, tall] of [[0.008 - top, 0.014], [top - 0.03, 0.006], [0.03 - top, 0.004]] as const) root.add(at(prism([x + 0.0012, y + 0.0012, tall], 0.0105, band, 0.002), 0, 0, up));
      hinge.rotation.x = Math.PI / 2;
      root.add(hinge);
      for (let k = 0; k < 8; k++) {
        const biscuit = bar(shop, 0.024, 0.0085, baked, 0, (k - 3.5) * 0.0105 * y / 0.09, top - 0.032);
        biscuit.rotation.x = Math.PI / 2 + 0.12 * ((k % 3) - 1);
        root.add(biscuit);
      }
      // Pictures towards the person, and towards the free side.
      for (const [wide, turn, px, py] of [[0.062, -Math.PI / 2, -x / 2 - 0.0008, 0], [0.046, 0, 0, y / 2 + 0.0008], [0.046, Math.PI, 0, -y / 2 - 0.0008]] as const) {
        const label = shaded(new PlaneGeometry(wide, 1.4 * wide).rotateX(Math.PI / 2).rotateZ(turn === 0 ? Math.PI : turn === Math.PI ? 0 : turn), surface(shop.quality, { map: labelPicture(), transparent: true, roughness: 0.6 }));
        label.castShadow = false;
        root.add(at(label, px, py, -0.008));
      }
      return root;
    },
    lid(body) {
      const root = new Group(), [x, y, z] = sizeOf(shapeOf(body, ShapeType.Box)), red = shop.paint(colorOf(body)), edge = 0.0015;
      const outline = rounded(new Shape(), -x / 2 + edge, x / 2 - edge, y / 2 - edge, 0.009, 0.024);
      root.add(shaded(new ExtrudeGeometry(outline, { depth: z - 2 * edge, bevelSize: edge, bevelThickness: edge, bevelSegments: 2, curveSegments: 8 }).translate(0, 0, edge - z / 2), red));
      root.add(at(prism([0.4 * x, 0.7 * y, 0.003], 0.018, shop.paint('#dd7a5f')), 0.2 * x, 0, z / 2 + 0.001));
      return root;
    },
  };
  return { model: (body) => models[String(body.name)]?.(body), show() { /* The lid itself moves. */ } };
}

/** A round biscuit between two ears of wheat, without words. */
function labelPicture(): ReturnType<typeof picture> {
  return picture(256, 358, (pen: Pen) => {
    pen.fillStyle = '#fff6e0';
    pen.strokeStyle = '#a8402c';
    pen.lineWidth = 7;
    pen.beginPath();
    pen.roundRect(6, 6, 244, 346, 40);
    pen.fill();
    pen.stroke();
    pen.fillStyle = '#d9a45c';
    pen.strokeStyle = '#9a6730';
    pen.beginPath();
    pen.arc(128, 140, 74, 0, 7);
    pen.fill();
    pen.stroke();
    pen.fillStyle = '#9a6730';
    for (let i = 0; i < 7; i++) {
      pen.beginPath();
      pen.arc(128 + (i === 0 ? 0 : 40 * Math.cos(i)), 140 + (i === 0 ? 0 : 40 * Math.sin(i)), 7, 0, 7);
      pen.fill();
    }
    pen.fillStyle = '#c08a2e';
    for (const side of [-1, 1]) for (let k = 0; k < 5; k++) {
      pen.beginPath();
      pen.ellipse(128 + side * (26 + 13 * k), 300 - 9 * k, 16, 7, -side * 0.9, 0, 7);
      pen.fill();
    }
  });
}

/** The device of a task; undefined: its bodies are drawn by their shapes. @param right whether the hand is a right one */
export function applianceOf(task: string, right: boolean, shop: Workshop): Appliance | undefined {
  switch (task) {
    case 'coffee-mill': return coffeeMill(shop);
    case 'press-lever': return pressLever(shop, right ? 1 : -1);
    case 'flip-top-lid': return biscuitTin(shop);
    default: return undefined;
  }
}
