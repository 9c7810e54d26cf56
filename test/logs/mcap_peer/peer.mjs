// An independent reader of MCAP files (@mcap/core), for the tests of our writer.
//
//   node peer.mjs FILE
//
// Prints the content of FILE. First one line per topic of the summary, in the order of the ids:
// "summary TOPIC SCHEMA MESSAGES". Then one line per message, found by the index: "message TOPIC
// TIME_NS JSON". Then reads FILE again from front to back, including checksums. Fails unless both
// readings agree and each message is JSON whose members are all in its schema.
import {open, readFile} from 'node:fs/promises';
import assert from 'node:assert';
import {crc32} from '@foxglove/crc';
import {decompress} from 'fzstd';
import {McapIndexedReader, McapStreamReader} from '@mcap/core';

const path = process.argv[2];
const whole = await readFile(path);
const file = await open(path);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, length) => {
    const buffer = new Uint8Array(Number(length));
    const {bytesRead} = await file.read(buffer, 0, Number(length), Number(offset));
    assert.equal(bytesRead, Number(length));
    return buffer;
  },
};

// A zstd decoder that also shares no code with our writer.
const decompressHandlers = {
  zstd: (bytes, size) => {
    const out = decompress(bytes);
    assert.equal(BigInt(out.length), size);
    return out;
  },
};
const text = new TextDecoder('utf-8', {fatal: true});
const line_of = (topic, message) =>
    `message ${topic} ${message.logTime} ${text.decode(message.data)}`;

const indexed = await McapIndexedReader.Initialize({readable, decompressHandlers});
const lines = [];
for (const [id, channel] of [...indexed.channelsById].sort((a, b) => a[0] - b[0])) {
  const schema = indexed.schemasById.get(channel.schemaId);
  assert.equal(channel.messageEncoding, 'json');
  assert.equal(schema.encoding, 'jsonschema');
  assert.equal(JSON.parse(text.decode(schema.data)).type, 'object');
  lines.push(`summary ${channel.topic} ${schema.name} ` +
             `${indexed.statistics.channelMessageCounts.get(id) ?? 0n}`);
}
const by_index = [];
for await (const message of indexed.readMessages()) {
  const channel = indexed.channelsById.get(message.channelId);
  const known = JSON.parse(text.decode(indexed.schemasById.get(channel.schemaId).data)).properties;
  for (const member of Object.keys(JSON.parse(text.decode(message.data)))) {
    assert.ok(member in known, `${channel.topic}: its schema does not know ${member}`);
  }
  by_index.push(line_of(channel.topic, message));
}
assert.equal(BigInt(by_index.length), indexed.statistics.messageCount);
const kDataEndBytes = 1 + 8 + 4;
const data_section = whole.subarray(0, Number(indexed.footer.summaryStart) - kDataEndBytes);
assert.equal(crc32(data_section), indexed.dataSectionCrc);

const stream = new McapStreamReader({validateCrcs: true, includeChunks: true, decompressHandlers});
stream.append(whole);
const topics = new Map();
const in_order = [];
for (let record; (record = stream.nextRecord());) {
  if (record.type === 'Channel') {
    topics.set(record.id, record.topic);
  } else if (record.type === 'Message') {
    in_order.push(line_of(topics.get(record.channelId), record));
  }
}
assert.ok(stream.done(), 'the file goes on, or ends early');
assert.deepEqual([...in_order].sort(), [...by_index].sort());
console.log([...lines, ...by_index].join('\n'));
