// Brings a report page to life: views in space, tabs, sorting, links between views and pictures. Everything it shows
// is in the page; nothing is fetched.
(function () {
    'use strict';

    const kTypes = { f8: [Float64Array, 8], f4: [Float32Array, 4], i4: [Int32Array, 4], u4: [Uint32Array, 4], u2: [Uint16Array, 2] };
    const kNoInteger = -2147483648;
    const kMarkColours = { best: 0x009e73, worst: 0xd55e00 };

    function element(name, attributes, ...children) {
        const made = document.createElement(name);
        for (const [key, value] of Object.entries(attributes || {}))
            if (key.startsWith('on')) made.addEventListener(key.slice(2), value);
            else if (value !== undefined && value !== null) made.setAttribute(key, value);
        made.append(...children.filter((child) => child !== null && child !== undefined));
        return made;
    }

    // Six digits, as the tables have them.
    function numberText(x) {
        return Number.isFinite(x) ? String(Number(x.toPrecision(6))).replace('e+', 'e') : '\u2013';
    }

    // ---- data -------------------------------------------------------------------------------------------------

    async function unpack(text) {
        const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
        const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
        return new Response(stream).arrayBuffer();
    }

    class Data {
        constructor(description, buffer) {
            this.description = description;
            this.buffer = buffer;
            this.tables = {};
            for (const map of ['sequential', 'diverging']) {
                const text = description[map];
                this.tables[map] = new Float32Array(text.length / 2);
                for (let i = 0; i < this.tables[map].length; ++i)
                    this.tables[map][i] = parseInt(text.slice(2 * i, 2 * i + 2), 16) / 255;
            }
        }
        array(a) {
            const [Type] = kTypes[a.t];
            return new Type(this.buffer, a.o, a.n);
        }
        points(a, scene) {
            const raw = this.array(a), points = new Float32Array(raw.length);
            for (let i = 0; i < raw.length; ++i) {
                const k = i % 3;
                points[i] = scene.low[k] + (scene.high[k] - scene.low[k]) * raw[i] / 65535;
            }
            return points;
        }
    }

    // The place of a value on a colour bar: 0 to 1, NaN for none.
    function fraction(field, value) {
        if (!Number.isFinite(value)) return NaN;
        if (field.low === field.high) return 0.5;
        if (field.log) return value > 0 ? Math.min(1, Math.max(0, Math.log(value / field.low) / Math.log(field.high / field.low))) : 0;
        return Math.min(1, Math.max(0, (value - field.low) / (field.high - field.low)));
    }

    function valuesOf(data, field) {
        if (!field.array) {
            field.array = data.array(field.values);
            if (field.values.t === 'i4') field.array = Float64Array.from(field.array, (x) => (x === kNoInteger ? NaN : x));
        }
        return field.array;
    }

    // ---- drawing: one renderer for all views -----------------------------------------------------------------------

    let renderer = null;
    let rendererFailed = false;
    function sharedRenderer() {
        if (renderer || rendererFailed) return renderer;
        try {
            renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true, alpha: false });
            renderer.setClearColor(0xffffff, 1);
        } catch (error) {
            rendererFailed = true;
            document.querySelector('main').prepend(element('p', { class: 'note fails', role: 'alert' },
                'This browser has no WebGL, which the views in space and the small pictures of surfaces need: they stay empty. All else is here.'));
        }
        return renderer;
    }

    function drawOn(canvas, scene, camera, materials) {
        const gl = sharedRenderer();
        if (!gl) return false;
        const width = Math.max(1, canvas.width), height = Math.max(1, canvas.height);
        gl.setPixelRatio(1);
        gl.setSize(width, height, false);
        for (const m of materials || []) m.resolution.set(width, height);
        gl.render(scene, camera);
        const context = canvas.getContext('2d');
        context.drawImage(gl.domElement, 0, 0, width, height);
        return true;
    }

    function surfaceGeometry(points, triangles) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(points, 3));
        geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
        geometry.computeVertexNormals();
        return geometry;
    }

    function lit(parameters) {
        return new THREE.MeshLambertMaterial(Object.assign({ side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }, parameters));
    }

    function makeStage(description) {
        const scene = new THREE.Scene();
        scene.add(new THREE.HemisphereLight(0xffffff, 0x9a9aa0, 0.75));
        const camera = new THREE.PerspectiveCamera(35, 4 / 3, 0.01, 100);
        const lamp = new THREE.DirectionalLight(0xffffff, 0.45);
        lamp.position.set(-0.5, 0.8, 1);
        camera.add(lamp);
        scene.add(camera);
        const centre = [0, 1, 2].map((k) => (description.low[k] + description.high[k]) / 2);
        const size = Math.hypot(...[0, 1, 2].map((k) => description.high[k] - description.low[k])) || 1;
        return { scene, camera, centre, size };
    }

    // Looks along the least extended axis, the longest across.
    function placeCamera(stage, description) {
        const extent = [0, 1, 2].map((k) => description.high[k] - description.low[k]);
        const order = [0, 1, 2].sort((a, b) => extent[a] - extent[b]);
        const along = new THREE.Vector3(), up = new THREE.Vector3();
        along.setComponent(order[0], 1);
        up.setComponent(order[1], 1);
        const across = new THREE.Vector3().crossVectors(up, along);
        along.addScaledVector(up, 0.45).addScaledVector(across, 0.35).normalize();
        stage.camera.up.copy(up);
        const target = new THREE.Vector3(...stage.centre);
        const distance = 0.5 * stage.size / Math.sin(THREE.Math.degToRad(stage.camera.fov / 2)) * 0.8;
        stage.camera.position.copy(target).addScaledVector(along, distance);
        stage.camera.near = stage.size / 1000;
        stage.camera.far = stage.size * 20;
        stage.camera.lookAt(target);
        stage.camera.updateProjectionMatrix();
        return target;
    }

    function checkerTexture() {
        const n = 64, pixels = new Uint8Array(4 * n * n);
        for (let y = 0; y < n; ++y)
            for (let x = 0; x < n; ++x) {
                const dark = (x < n / 2) !== (y < n / 2);
                pixels.set(dark ? [70, 84, 110, 255] : [250, 250, 246, 255], 4 * (y * n + x));
            }
        const texture = new THREE.DataTexture(pixels, n, n, THREE.RGBAFormat);
        texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
        texture.magFilter = THREE.LinearFilter;
        texture.minFilter = THREE.LinearMipMapLinearFilter;
        texture.generateMipmaps = true;
        texture.anisotropy = 8;
        texture.needsUpdate = true;
        return texture;
    }

    // What makes square points round.
    function discTexture() {
        const n = 32, pixels = new Uint8Array(4 * n * n);
        for (let y = 0; y < n; ++y)
            for (let x = 0; x < n; ++x) {
                const inside = Math.hypot(x - (n - 1) / 2, y - (n - 1) / 2) < n / 2 - 1;
                pixels.set([255, 255, 255, inside ? 255 : 0], 4 * (y * n + x));
            }
        const texture = new THREE.DataTexture(pixels, n, n, THREE.RGBAFormat);
        texture.needsUpdate = true;
        return texture;
    }

    // ---- a view ---------------------------------------------------------------------------------------------------

    class View {
        constructor(figure, description, data) {
            this.figure = figure;
            this.d = description;
            this.data = data;
            this.vertex = data.array(description.vertex);
            this.points = data.points(description.points, description);
            this.stage = makeStage(description);
            this.lineMaterials = [];
            this.layers = [];
            this.buildSurface();
            this.buildCurves();
            this.buildMarks();
            this.buildPage();
            this.show(0);
        }

        buildSurface() {
            const geometry = surfaceGeometry(this.points, this.data.array(this.d.triangles));
            geometry.setAttribute('color', new THREE.BufferAttribute(new Float32Array(this.points.length), 3));
            this.surface = new THREE.Mesh(geometry, lit({ vertexColors: THREE.VertexColors }));
            this.stage.scene.add(this.surface);
            for (const field of this.d.fields) if (field.map) this.layers.push({ name: field.name, field });
            for (const texture of this.d.textures) this.layers.push({ name: texture.name, texture });
            if (this.layers.length === 0) this.layers.push({ name: 'surface' });
        }

        // Lines are drawn a little towards the viewer, which hides them less where they lie on the surface.
        line(points, colour, width, dashed) {
            const flat = new THREE.LineGeometry();
            flat.setPositions(points);
            const material = new THREE.LineMaterial({ color: colour, linewidth: width, dashed: Boolean(dashed) });
            if (dashed) {
                material.defines.USE_DASH = '';
                material.dashSize = this.stage.size / 60;
                material.gapSize = this.stage.size / 90;
                material.dashScale = 1;
            }
            this.lineMaterials.push(material);
            const line = new THREE.Line2(flat, material);
            if (dashed) line.computeLineDistances();
            return line;
        }

        buildCurves() {
            this.curves = [];
            for (const curve of this.d.curves) {
                const points = Array.from(this.data.array(curve.points));
                if (points.length < 6) continue;
                const line = this.line(points, curve.colour, 3.5, curve.dashed);
                line.visible = !curve.hidden;
                this.stage.scene.add(line);
                this.curves.push({ curve, line });
            }
        }

        ball(point, colour, size) {
            const mesh = new THREE.Mesh(new THREE.SphereBufferGeometry(size * this.stage.size, 20, 14),
                new THREE.MeshBasicMaterial({ color: colour }));
            mesh.position.set(...point);
            return mesh;
        }

        buildMarks() {
            this.marks = [];
            for (const mark of this.d.marks) {
                const group = new THREE.Group();
                const ring = this.ball(mark.point, 0x000000, 0.0135);
                ring.material.side = THREE.BackSide;
                group.add(ring, this.ball(mark.point, kMarkColours[mark.name] || 0xffffff, 0.0115));
                this.stage.scene.add(group);
                this.marks.push({ mark, group });
            }
            this.cursor = new THREE.Group();
            const halo = this.ball([0, 0, 0], 0xffffff, 0.0115);
            halo.material.side = THREE.BackSide;
            this.cursor.add(halo, this.ball([0, 0, 0], 0x000000, 0.0085));
            this.cursor.visible = false;
            this.stage.scene.add(this.cursor);
        }

        buildPage() {
            const d = this.d;
            this.canvas = element('canvas', { tabindex: 0, role: 'application', width: 640, height: 480, 'aria-label': `View of ${d.title}. Arrow keys turn it, plus and minus zoom, R resets.` });
            this.hint = element('span', { class: 'hint' }, 'drag to turn, click a vertex');
            this.chooser = element('select', { onchange: () => this.show(this.chooser.selectedIndex), 'aria-label': 'Colour by' },
                ...this.layers.map((layer) => element('option', {}, layer.name)));
            this.vertexInput = element('input', { type: 'number', min: 0, step: 1, 'aria-label': 'Vertex number' });
            const go = (event) => { event.preventDefault(); if (this.vertexInput.value !== '') this.pickVertex(Number(this.vertexInput.value)); };
            const form = element('form', { onsubmit: go }, element('label', {}, 'vertex ', this.vertexInput), ' ', element('button', {}, 'show'));
            const tools = element('div', { class: 'tools' },
                this.layers.length > 1 ? element('label', {}, 'colour by ', this.chooser) : null, form,
                element('button', { type: 'button', onclick: () => this.reset() }, 'reset'));
            for (const { mark } of this.marks)
                tools.append(element('button', { type: 'button', onclick: () => this.pickVertex(mark.vertex, mark.point) }, mark.name));
            this.bar = element('div', { class: 'bar' });
            this.legend = element('div', { class: 'legend' });
            this.readout = element('dl', { class: 'readout', 'aria-live': 'polite' }, element('div', { class: 'empty' }, 'Click the surface, or type a vertex number, to read its numbers.'));
            this.figure.replaceChildren(tools, element('div', { class: 'stage' }, this.canvas, this.hint), this.bar, this.legend, this.readout);
            this.buildLegend();
            this.target = placeCamera(this.stage, d);
            this.controls = new THREE.OrbitControls(this.stage.camera, this.canvas);
            this.controls.target.copy(this.target);
            this.controls.update();
            this.controls.enableKeys = false;
            this.controls.enableZoom = false;  // until it is chosen: the page must scroll
            if (window.matchMedia('(pointer: coarse)').matches) {
                // One finger scrolls the page until the view is asked to turn.
                this.controls.enabled = false;
                const turn = element('button', { type: 'button', 'aria-pressed': 'false' }, 'turn by touch');
                turn.addEventListener('click', () => {
                    this.controls.enabled = !this.controls.enabled;
                    turn.setAttribute('aria-pressed', String(this.controls.enabled));
                    this.canvas.style.touchAction = this.controls.enabled ? 'none' : 'auto';
                });
                tools.append(turn);
                this.hint.textContent = 'tap a vertex';
            }
            new ResizeObserver(() => this.draw()).observe(this.canvas);
            this.controls.addEventListener('change', () => this.draw());
            this.canvas.addEventListener('focus', () => { this.controls.enableZoom = true; });
            this.canvas.addEventListener('blur', () => { this.controls.enableZoom = false; });
            this.canvas.addEventListener('pointerdown', (event) => { this.down = [event.clientX, event.clientY]; });
            this.canvas.addEventListener('pointerup', (event) => {
                if (this.down && Math.hypot(event.clientX - this.down[0], event.clientY - this.down[1]) < 5) this.click(event);
                this.canvas.focus({ preventScroll: true });
                this.hint.textContent = '';
            });
            this.canvas.addEventListener('keydown', (event) => this.key(event));
        }

        buildLegend() {
            for (const { mark } of this.marks) {
                const dot = element('i', { class: 'mark' });
                dot.style.background = '#' + (kMarkColours[mark.name] || 0xffffff).toString(16).padStart(6, '0');
                this.legend.append(element('span', {}, dot, ` ${mark.name}: vertex ${mark.vertex}`));
            }
            this.curves.forEach((c) => {
                const sample = element('i', { class: c.curve.dashed ? 'dashed' : '' });
                sample.style.borderTopColor = c.curve.colour;
                const button = element('button', { type: 'button', 'aria-pressed': String(c.line.visible) }, sample, c.curve.name);
                button.addEventListener('click', () => {
                    c.line.visible = !c.line.visible;
                    button.setAttribute('aria-pressed', String(c.line.visible));
                    this.draw();
                });
                for (const [enter, on] of [['pointerenter', true], ['pointerleave', false], ['focus', true], ['blur', false]])
                    button.addEventListener(enter, () => this.light(c, on, true));
                c.button = button;
                this.legend.append(button);
            });
        }

        // A curve and its sides in the picture of the domain.
        light(c, on, pictures) {
            c.line.material.linewidth = on ? 7 : 3.5;
            c.button.style.fontWeight = on ? '700' : '';
            if (pictures)
                for (const side of sidesOf(c.curve.link, c.curve.name)) side.classList.toggle('lit', on);
            this.draw();
        }

        show(number) {
            const layer = this.layers[number];
            this.layer = layer;
            this.bar.replaceChildren(...(layer.texture ? [element('div', { class: 'facts' }, layer.name)] : []));
            if (this.textured) this.textured.visible = false;
            if (this.dots) this.stage.scene.remove(this.dots);
            this.dots = null;
            this.surface.visible = !layer.texture;
            if (layer.texture) this.showTexture(layer);
            else this.colour(layer.field);
            this.draw();
        }

        showTexture(layer) {
            if (!layer.mesh) {
                const t = layer.texture;
                const geometry = surfaceGeometry(this.data.points(t.points, this.d), this.data.array(t.triangles));
                const uv = Float32Array.from(this.data.array(t.uv), (x) => x / 2);
                geometry.setAttribute('uv', new THREE.BufferAttribute(uv, 2));
                layer.mesh = new THREE.Mesh(geometry, lit({ map: checkerTexture() }));
                this.smooth(geometry);
                this.stage.scene.add(layer.mesh);
            }
            layer.mesh.visible = true;
            this.textured = layer.mesh;
        }

        // Vertices along the cut are there more than once: their normals are added up by place.
        smooth(geometry) {
            const p = geometry.attributes.position.array, n = geometry.attributes.normal.array, sum = new Map();
            for (let i = 0; i < p.length; i += 3) {
                const key = `${p[i]},${p[i + 1]},${p[i + 2]}`, s = sum.get(key) || [0, 0, 0];
                for (let k = 0; k < 3; ++k) s[k] += n[i + k];
                sum.set(key, s);
            }
            for (let i = 0; i < p.length; i += 3) {
                const s = sum.get(`${p[i]},${p[i + 1]},${p[i + 2]}`), size = Math.hypot(...s) || 1;
                for (let k = 0; k < 3; ++k) n[i + k] = s[k] / size;
            }
        }

        colour(field) {
            const colours = this.surface.geometry.attributes.color;
            if (!field) {
                colours.array.fill(0.75);
                colours.needsUpdate = true;
                return;
            }
            const values = valuesOf(this.data, field), table = this.data.tables[field.map], last = table.length / 3 - 1;
            let missing = false;
            for (let v = 0; v < values.length; ++v) {
                const t = fraction(field, values[v]);
                missing = missing || Number.isNaN(t);
                for (let k = 0; k < 3; ++k)
                    colours.array[3 * v + k] = Number.isNaN(t) ? 0.62 : table[3 * Math.round(t * last) + k];
            }
            colours.needsUpdate = true;
            this.showDots(values, colours.array);
            this.colourBar(field, table, last, missing);
        }

        // Where few vertices have a value (a sampled sweep) they are shown as dots: colours that run into grey between them
        // would say something about places that nobody looked at.
        showDots(values, colours) {
            const known = [];
            let seen = 0;
            for (let v = 0; v < values.length; ++v)
                if (Number.isFinite(values[v])) {
                    if (v < this.d.shown) ++seen;
                    if (this.d.shown === values.length || v >= this.d.shown) known.push(v);
                }
            if (known.length === 0 || seen > 0.8 * this.d.shown) return;
            const places = new Float32Array(3 * known.length), shades = new Float32Array(3 * known.length);
            known.forEach((v, i) => {
                for (let k = 0; k < 3; ++k) {
                    places[3 * i + k] = this.points[3 * v + k];
                    shades[3 * i + k] = colours[3 * v + k];
                }
            });
            colours.fill(0.86);
            const geometry = new THREE.BufferGeometry();
            geometry.setAttribute('position', new THREE.BufferAttribute(places, 3));
            geometry.setAttribute('color', new THREE.BufferAttribute(shades, 3));
            const size = Math.min(0.06, Math.max(0.012, 0.8 / Math.sqrt(known.length))) * this.stage.size;
            this.dots = new THREE.Points(geometry, new THREE.PointsMaterial({ size, vertexColors: THREE.VertexColors, map: discTexture(), alphaTest: 0.5 }));
            this.stage.scene.add(this.dots);
        }

        colourBar(field, table, last, missing) {
            const stops = [];
            for (let i = 0; i <= 24; ++i) {
                const at = 3 * Math.round(i / 24 * last), rgb = [0, 1, 2].map((k) => Math.round(255 * table[at + k]));
                stops.push(`rgb(${rgb.join(',')}) ${(100 * i / 24).toFixed(1)}%`);
            }
            const colours = element('div', { class: 'colours' });
            colours.style.background = `linear-gradient(to right, ${stops.join(', ')})`;
            const ticks = element('div', { class: 'ticks' });
            for (const t of field.ticks) {
                const at = 100 * fraction(field, t);
                const tick = element('span', {}, numberText(t));
                tick.style.left = `${Math.min(97, Math.max(3, at))}%`;
                ticks.append(tick);
            }
            const words = [field.name + (field.unit ? `, ${field.unit}` : ''), field.log ? 'logarithmic' : '', missing ? 'grey: no value' : ''];
            this.bar.append(colours, ticks, element('div', { class: 'facts' }, words.filter(Boolean).join('; ')));
        }

        draw() {
            if (this.waiting) return;
            this.waiting = true;
            requestAnimationFrame(() => { this.waiting = false; this.drawNow(); });
        }

        drawNow() {
            const box = this.canvas.getBoundingClientRect();
            if (box.width === 0) return;
            const ratio = Math.min(window.devicePixelRatio || 1, 2);
            const width = Math.round(box.width * ratio), height = Math.round(box.height * ratio);
            if (this.canvas.width !== width || this.canvas.height !== height) {
                this.canvas.width = width;
                this.canvas.height = height;
            }
            this.stage.camera.aspect = width / height;
            this.stage.camera.updateProjectionMatrix();
            drawOn(this.canvas, this.stage.scene, this.stage.camera, this.lineMaterials);
            this.figure.dataset.drawn = 'yes';
        }

        reset() {
            this.target = placeCamera(this.stage, this.d);
            this.controls.target.copy(this.target);
            this.controls.update();
            this.draw();
        }

        key(event) {
            const turn = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
            const camera = this.stage.camera, offset = camera.position.clone().sub(this.controls.target);
            if (turn) {
                const side = new THREE.Vector3().crossVectors(camera.up, offset).normalize();
                offset.applyAxisAngle(camera.up.clone().normalize(), turn[0]);
                const tilted = offset.clone().applyAxisAngle(side, turn[1]);
                if (Math.abs(tilted.clone().normalize().dot(camera.up.clone().normalize())) < 0.99) offset.copy(tilted);
            } else if (event.key === '+' || event.key === '=') {
                offset.multiplyScalar(0.9);
            } else if (event.key === '-') {
                offset.multiplyScalar(1.1);
            } else if (event.key === 'r' || event.key === 'R') {
                event.preventDefault();
                return this.reset();
            } else {
                return undefined;
            }
            event.preventDefault();
            camera.position.copy(this.controls.target).add(offset);
            this.controls.update();
            this.draw();
            return undefined;
        }

        click(event) {
            const box = this.canvas.getBoundingClientRect();
            const pointer = new THREE.Vector2(2 * (event.clientX - box.left) / box.width - 1, 1 - 2 * (event.clientY - box.top) / box.height);
            const ray = new THREE.Raycaster();
            ray.setFromCamera(pointer, this.stage.camera);
            this.surface.visible = true;
            const hit = ray.intersectObject(this.surface)[0];
            this.surface.visible = !this.layer.texture;
            if (!hit) return;
            const p = this.points;
            const corners = [hit.face.a, hit.face.b, hit.face.c];
            const far = (v) => Math.hypot(p[3 * v] - hit.point.x, p[3 * v + 1] - hit.point.y, p[3 * v + 2] - hit.point.z);
            let nearest = corners.sort((a, b) => far(a) - far(b))[0], least = far(nearest);
            for (let v = this.d.shown; v < this.vertex.length; ++v)  // exact vertices of a decimated surface
                if (far(v) < least) [least, nearest] = [far(v), v];
            this.read(nearest);
        }

        // The surface's vertex, or the one of the view nearest to the point given.
        pickVertex(number, point) {
            if (!Number.isInteger(number)) return undefined;
            let found = Math.max(this.vertex.indexOf(number), this.vertex.indexOf(number, this.d.shown));
            if (found < 0 && point) {
                let least = Infinity;
                for (let v = 0; v < this.vertex.length; ++v) {
                    const far = Math.hypot(...[0, 1, 2].map((k) => this.points[3 * v + k] - point[k]));
                    if (far < least) [least, found] = [far, v];
                }
            }
            if (found >= 0) return this.read(found);
            const why = this.d.decimated ? 'is not among those shown (the surface is decimated for viewing)' : 'is not a vertex of this surface';
            this.readout.replaceChildren(element('div', { class: 'empty' }, `${number} ${why}.`));
            return undefined;
        }

        read(v) {
            const p = [0, 1, 2].map((k) => this.points[3 * v + k]);
            this.cursor.position.set(...p);
            this.cursor.visible = true;
            const number = this.vertex[v];
            const rows = [[this.d.decimated && v < this.d.shown ? 'nearest vertex' : 'vertex', String(number)]];
            for (const field of this.d.fields) {
                const value = valuesOf(this.data, field)[v];
                if (field.words) rows.push([field.name, Number.isFinite(value) ? field.words[value] : 'no row']);
                else rows.push([field.name, numberText(value)]);
            }
            rows.push(['position', p.map((x) => String(Number((Math.abs(x) < 1e-4 * this.stage.size ? 0 : x).toPrecision(4)))).join(', ')]);
            this.readout.replaceChildren(...rows.map(([name, value]) => element('div', {}, element('dt', {}, name), element('dd', {}, value))));
            this.figure.dataset.vertex = String(number);
            this.vertexInput.value = String(number);
            this.spotLayout(number);
            this.draw();
        }

        // Marks a vertex in the pictures of the layout: as often as the cut passes it.
        spotLayout(number) {
            if (!this.d.layout) return;
            const vertex = this.data.array(this.d.layout.vertex), points = this.data.array(this.d.layout.points);
            const places = [];
            for (let i = 0; i < vertex.length; ++i) if (vertex[i] === number) places.push([points[2 * i], points[2 * i + 1]]);
            for (const figure of picturesOf(this.d.layout.link)) {
                const svg = figure.querySelector('svg');
                svg.querySelectorAll('.spot').forEach((s) => s.remove());
                for (const [x, y] of places) {
                    const [px, py] = toPixel(svg, figure, x, y);
                    const spot = document.createElementNS('http://www.w3.org/2000/svg', 'circle');
                    for (const [key, value] of Object.entries({ class: 'spot', cx: px, cy: py, r: 5 })) spot.setAttribute(key, value);
                    svg.append(spot);
                }
            }
        }

        // From a click into the domain to the nearest vertex.
        pickLayout(x, y) {
            const vertex = this.data.array(this.d.layout.vertex), points = this.data.array(this.d.layout.points);
            let least = Infinity, found = -1;
            for (let i = 0; i < vertex.length; ++i) {
                const far = Math.hypot(points[2 * i] - x, points[2 * i + 1] - y);
                if (far < least) [least, found] = [far, vertex[i]];
            }
            if (found >= 0) this.pickVertex(found);
        }
    }

    // ---- pictures ---------------------------------------------------------------------------------------------------

    function picturesOf(link) {
        return link ? [...document.querySelectorAll(`figure[data-link~="${link}"]`)] : [];
    }

    function baseName(name) {
        return name.replace(/\^-1$/, '');
    }

    // The lines of a domain's sides with that name, both of a pair.
    function sidesOf(link, name) {
        const found = [];
        for (const figure of picturesOf(link))
            for (const title of figure.querySelectorAll('svg path > title'))
                if (baseName(title.textContent) === name) found.push(title.parentNode);
        return found;
    }

    // Klein's model k = 2 p / (1 + |p|^2) of a point p of Poincare's.
    function toPixel(svg, figure, x, y) {
        if (figure.dataset.link.split(' ').includes('klein')) {
            const s = 2 / (1 + x * x + y * y);
            [x, y] = [s * x, s * y];
        }
        const d = svg.dataset;
        return [(x - Number(d.left)) * Number(d.scale), (Number(d.top) - y) * Number(d.scale)];
    }

    function fromPixel(svg, figure, px, py) {
        const d = svg.dataset;
        let x = px / Number(d.scale) + Number(d.left), y = Number(d.top) - py / Number(d.scale);
        if (figure.dataset.link.split(' ').includes('klein')) {
            const s = 1 / (1 + Math.sqrt(Math.max(0, 1 - x * x - y * y)));
            [x, y] = [s * x, s * y];
        }
        return [x, y];
    }

    function linkPictures(views) {
        for (const view of views) {
            if (view.d.layout)
                for (const figure of picturesOf(view.d.layout.link)) {
                    const svg = figure.querySelector('svg');
                    svg.style.cursor = 'crosshair';
                    svg.addEventListener('click', (event) => {
                        const box = svg.getBoundingClientRect(), frame = svg.viewBox.baseVal;
                        view.pickLayout(...fromPixel(svg, figure, (event.clientX - box.left) * frame.width / box.width,
                            (event.clientY - box.top) * frame.height / box.height));
                    });
                }
            for (const c of view.curves)
                for (const side of sidesOf(c.curve.link, c.curve.name)) {
                    side.addEventListener('pointerenter', () => view.light(c, true, true));
                    side.addEventListener('pointerleave', () => view.light(c, false, true));
                }
        }
    }

    function makeTabs(group) {
        const figures = [...group.children], list = element('div', { class: 'tablist', role: 'tablist' });
        const show = (k) => figures.forEach((figure, i) => {
            figure.hidden = i !== k;
            list.children[i].setAttribute('aria-selected', String(i === k));
            list.children[i].tabIndex = i === k ? 0 : -1;
        });
        figures.forEach((figure, k) => {
            figure.setAttribute('role', 'tabpanel');
            list.append(element('button', {
                type: 'button', role: 'tab', onclick: () => show(k), onkeydown: (event) => {
                    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
                    if (!step) return;
                    const next = (k + step + figures.length) % figures.length;
                    show(next);
                    list.children[next].focus();
                },
            }, figure.dataset.tab || `picture ${k + 1}`));
        });
        group.prepend(list);
        show(0);
    }

    function makeSortable(table) {
        [...table.tHead.rows[0].cells].forEach((head, k) => {
            const words = head.textContent;
            if (!words) return;
            const button = element('button', { type: 'button', title: 'Sort by this column' }, words);
            head.replaceChildren(button);
            button.addEventListener('click', () => {
                const down = head.getAttribute('aria-sort') === 'ascending';
                for (const other of table.tHead.rows[0].cells) other.removeAttribute('aria-sort');
                head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
                const key = (row) => row.cells[k] ? row.cells[k].textContent.trim() : '';
                const compare = (a, b) => {
                    const x = Number(key(a)), y = Number(key(b));
                    const order = Number.isNaN(x) || Number.isNaN(y) || key(a) === '' || key(b) === ''
                        ? key(a).localeCompare(key(b), 'en', { numeric: true }) : x - y;
                    return down ? -order : order;
                };
                table.tBodies[0].append(...[...table.tBodies[0].rows].sort(compare));
            });
        });
    }

    // ---- thumbnails --------------------------------------------------------------------------------------------------

    function drawThumbnails(data) {
        const images = new Map();
        const draw = (place) => {
            const number = place.dataset.thumbnail, d = data.description.thumbnails[number];
            if (!images.has(number)) {
                const stage = makeStage(d);
                stage.scene.add(new THREE.Mesh(surfaceGeometry(data.points(d.points, d), data.array(d.triangles)), lit({ color: 0x8fa9c8 })));
                placeCamera(stage, d);
                const canvas = element('canvas', { width: 176, height: 132 });
                if (!drawOn(canvas, stage.scene, stage.camera)) return;
                images.set(number, canvas.toDataURL());
            }
            place.replaceChildren(element('img', { src: images.get(number), alt: '' }));
        };
        const places = [...document.querySelectorAll('[data-thumbnail]')];
        const watcher = new IntersectionObserver((entries) => {
            for (const entry of entries)
                if (entry.isIntersecting) {
                    watcher.unobserve(entry.target);
                    draw(entry.target);
                }
        }, { rootMargin: '400px' });
        places.forEach((place) => watcher.observe(place));
        window.addEventListener('beforeprint', () => places.forEach((place) => { if (!place.firstChild) draw(place); }));
    }

    // ---- start -------------------------------------------------------------------------------------------------------

    function makeViews(data) {
        const views = [];
        const make = (figure) => {
            if (figure.view) return;
            figure.view = new View(figure, data.description.scenes[Number(figure.dataset.scene)], data);
            views.push(figure.view);
            linkPictures([figure.view]);
        };
        const figures = [...document.querySelectorAll('[data-scene]')];
        const watcher = new IntersectionObserver((entries) => {
            for (const entry of entries)
                if (entry.isIntersecting) {
                    watcher.unobserve(entry.target);
                    make(entry.target);
                }
        }, { rootMargin: '600px' });
        figures.forEach((figure) => watcher.observe(figure));
        window.addEventListener('beforeprint', () => figures.forEach((figure) => { make(figure); figure.view.drawNow(); }));
    }

    async function start() {
        document.querySelectorAll('.tabs').forEach(makeTabs);
        document.querySelectorAll('table').forEach(makeSortable);
        let opened = [];
        window.addEventListener('beforeprint', () => {
            opened = [...document.querySelectorAll('details:not([open])')];
            for (const d of opened) d.open = true;
        });
        window.addEventListener('afterprint', () => { for (const d of opened) d.open = false; });
        const description = document.getElementById('ricci-data');
        if (description) {
            const buffer = await unpack(document.getElementById('ricci-bytes').textContent);
            const data = new Data(JSON.parse(description.textContent), buffer);
            makeViews(data);
            drawThumbnails(data);
        }
        document.documentElement.dataset.ready = 'yes';
    }

    start().catch((error) => {
        console.error(error);
        document.querySelector('main').prepend(element('p', { class: 'note fails' }, `The views could not be shown: ${error}`));
    });
}());
