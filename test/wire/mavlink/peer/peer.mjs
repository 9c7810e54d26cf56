// An independent reader and writer of MAVLink frames (node-mavlink), for the codec's tests.
//
//   node peer.mjs DIR
//
// For each NAME.values in DIR, NAME.frames holds the same messages as consecutive frames. Writes
// NAME.decoded, the values that node-mavlink reads from the frames, in the format of NAME.values;
// and NAME.encoded, the frames that node-mavlink makes of the values.
//
// NAME.values has a line "id name", a line "type name count …" (count 0: no array), then one line
// per message with all its numbers in wire order: integers in decimal, floats as their 32 bits,
// characters as bytes. Frame k has the sequence number k mod 256, system 1, component 191.
import {createRequire} from 'node:module';
import {readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {Readable} from 'node:stream';

const require = createRequire(import.meta.url);
const {ardupilotmega, common, minimal, standard, MavLinkPacketParser, MavLinkPacketSignature,
       MavLinkPacketSplitter, MavLinkProtocolV2} = require('node-mavlink');
const registry = {...minimal.REGISTRY, ...standard?.REGISTRY, ...common.REGISTRY,
                  ...ardupilotmega.REGISTRY};

const scratch = new DataView(new ArrayBuffer(4));
const bits_of = (value) => (scratch.setFloat32(0, value), scratch.getUint32(0));
const float_of = (bits) => (scratch.setUint32(0, bits), scratch.getFloat32(0));

/** Returns the fields of `clazz` in the order of the header; throws an error that names a difference. */
function match_fields(clazz, header) {
  const words = header.split(' ');
  const fields = [];
  for (let i = 0; i < words.length; i += 3) {
    const [type, name, count] = [words[i], words[i + 1], Number(words[i + 2])];
    const field = clazz.FIELDS.find((candidate) => candidate.source === name);
    if (!field) throw new Error(`${clazz.MSG_NAME} has no field ${name}`);
    const its_type = field.type.replace('[]', '').replace('uint8_t_mavlink_version', 'uint8_t');
    if (its_type !== type || field.length !== count) {
      throw new Error(`${clazz.MSG_NAME}.${name}: ${field.type} × ${field.length}, not ` +
                      `${type} × ${count}`);
    }
    fields.push({name: field.name, type, count});
  }
  return fields;
}

function values_of(message, fields) {
  const out = [];
  for (const {name, type, count} of fields) {
    const value = message[name];
    if (type === 'char') {
      for (let i = 0; i < count; ++i) out.push(i < value.length ? value.charCodeAt(i) : 0);
    } else {
      for (const x of count ? value : [value]) out.push(type === 'float' ? bits_of(x) : x);
    }
  }
  return out.join(' ');
}

function message_of(clazz, fields, line) {
  const numbers = line.split(' ');
  let at = 0;
  const one = (type) => {
    const text = numbers[at++];
    if (type === 'float') return float_of(Number(text));
    return type.endsWith('64_t') ? BigInt(text) : Number(text);
  };
  const message = new clazz();
  for (const {name, type, count} of fields) {
    if (type === 'char') {
      const codes = numbers.slice(at, at + count).map(Number);
      at += count;
      message[name] = String.fromCharCode(...codes).replace(/\0+$/, '');
    } else {
      message[name] = count ? Array.from({length: count}, () => one(type)) : one(type);
    }
  }
  return message;
}

async function packets_in(buffer) {
  const packets = [];
  const parsed = Readable.from([buffer]).pipe(new MavLinkPacketSplitter())
                     .pipe(new MavLinkPacketParser());
  for await (const packet of parsed) packets.push(packet);
  return packets;
}

async function exchange(dir, name) {
  const [head, header, ...lines] =
      readFileSync(join(dir, `${name}.values`), 'utf8').trimEnd().split('\n');
  const clazz = registry[Number(head.split(' ')[0])];
  if (!clazz || clazz.MSG_NAME !== name) throw new Error(`no message ${head}`);
  const fields = match_fields(clazz, header);
  const protocol = new MavLinkProtocolV2(1, 191);
  const decoded = (await packets_in(readFileSync(join(dir, `${name}.frames`))))
                      .map((packet) => values_of(protocol.data(packet.payload, clazz), fields));
  writeFileSync(join(dir, `${name}.decoded`), [head, header, ...decoded].join('\n') + '\n');
  const encoded = lines.map((line, k) =>
      protocol.serialize(message_of(clazz, fields, line), k % 256));
  writeFileSync(join(dir, `${name}.encoded`), Buffer.concat(encoded));
}

/** Reads signed.frames, HEARTBEATs that this codec signed. Writes the number of frames with a valid
 * signature of the key signed.key, and the same messages signed by node-mavlink. */
async function exchange_signed(dir) {
  const key = readFileSync(join(dir, 'signed.key'));
  const packets = await packets_in(readFileSync(join(dir, 'signed.frames')));
  const good = packets.filter((packet) => packet.signature?.matches(key)).length;
  writeFileSync(join(dir, 'signed.good'), `${good}\n`);
  const protocol = new MavLinkProtocolV2(1, 191, MavLinkProtocolV2.IFLAG_SIGNED);
  const resigned = packets.map((packet, k) => {
    const plain = protocol.serialize(
        protocol.data(packet.payload, registry[packet.header.msgid]), packet.header.seq);
    return protocol.sign(plain, 7, key, Date.UTC(2026, 0, 1) + k);
  });
  writeFileSync(join(dir, 'signed.resigned'), Buffer.concat(resigned));
}

const dir = process.argv[2];
for (const file of readdirSync(dir).filter((candidate) => candidate.endsWith('.values'))) {
  await exchange(dir, file.replace('.values', ''));
}
await exchange_signed(dir);
