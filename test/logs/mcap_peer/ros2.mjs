// An independent reader of MCAP files of ROS 2 messages (@mcap/core, @foxglove/rosmsg,
// @foxglove/rosmsg2-serialization), for the tests of the profile "ros2".
//
//   node ros2.mjs FILE
//
// Prints "TOPIC TYPE STAMP_NS JSON" for each message. Each message is decoded by the schema in the
// file, and encoding it again must give the same bytes.
import {open} from 'node:fs/promises';
import assert from 'node:assert';
import {decompress} from 'fzstd';
import {McapIndexedReader} from '@mcap/core';
import {parse} from '@foxglove/rosmsg';
import {MessageReader, MessageWriter} from '@foxglove/rosmsg2-serialization';

const file = await open(process.argv[2]);
const readable = {
  size: async () => BigInt((await file.stat()).size),
  read: async (offset, length) => {
    const buffer = new Uint8Array(Number(length));
    await file.read(buffer, 0, Number(length), Number(offset));
    return buffer;
  },
};
const decompressHandlers = {zstd: (bytes) => decompress(bytes)};
const indexed = await McapIndexedReader.Initialize({readable, decompressHandlers});
assert.equal(indexed.header.profile, 'ros2');
const coders = new Map();
for (const [id, channel] of indexed.channelsById) {
  const schema = indexed.schemasById.get(channel.schemaId);
  assert.equal(channel.messageEncoding, 'cdr');
  assert.equal(schema.encoding, 'ros2msg');
  assert.match(channel.topic, /^(\/[A-Za-z][A-Za-z0-9_]*)+$/);
  const definitions = parse(new TextDecoder().decode(schema.data), {ros2: true});
  coders.set(id, {topic: channel.topic, type: schema.name, reader: new MessageReader(definitions),
                  writer: new MessageWriter(definitions)});
}
const plain = (_, value) => ArrayBuffer.isView(value) ? [...value].map(Number)
  : typeof value === 'bigint' ? Number(value) : value;
for await (const message of indexed.readMessages()) {
  const {topic, type, reader, writer} = coders.get(message.channelId);
  const content = reader.readMessage(message.data);
  assert.deepEqual(Buffer.from(writer.writeMessage(content)), Buffer.from(message.data), topic);
  console.log(`${topic} ${type} ${message.publishTime} ${JSON.stringify(content, plain)}`);
}
