// Reads an MCAP file by Foxglove's libraries and prints each message as a line of JSON.
// Whole numbers of 64 bits and what JSON has no word for (NaN, Infinity) become strings.

import { readFile } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import rosmsg from "@foxglove/rosmsg";
import serialization from "@foxglove/rosmsg2-serialization";
import { decompress } from "fzstd";

function plain(_key, value) {
  if (typeof value === "bigint") return value.toString();
  if (typeof value === "number" && !Number.isFinite(value)) return String(value);
  if (ArrayBuffer.isView(value)) return Array.from(value);
  return value;
}

const content = await readFile(process.argv[2]);
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(content.length),
    read: async (offset, size) => new Uint8Array(content.subarray(Number(offset), Number(offset + size))),
  },
  decompressHandlers: { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) },
});
const decoders = new Map();
for (const channel of reader.channelsById.values()) {
  const schema = reader.schemasById.get(channel.schemaId);
  const definition = rosmsg.parse(new TextDecoder().decode(schema.data), { ros2: true });
  const decoder = new serialization.MessageReader(definition);
  decoders.set(channel.id, { topic: channel.topic, type: schema.name, decoder });
}
for await (const message of reader.readMessages({ validateCrcs: true })) {
  const { topic, type, decoder } = decoders.get(message.channelId);
  const row = { topic, type, log_time_ns: message.logTime, message: decoder.readMessage(message.data) };
  process.stdout.write(JSON.stringify(row, plain) + "\n");
}
