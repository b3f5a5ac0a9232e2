// The messages, as flatc writes them from protocol/wholehand.fbs ("npm run protocol").
export * from './generated/wholehand_generated';

/** What this page reads; a program that says another number is refused (Message.schema_version). */
export const SCHEMA_VERSION = 1;
