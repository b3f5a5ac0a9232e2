export const startSkinWorker = (): Worker => new Worker(new URL('./skin_worker.ts', import.meta.url), { type: 'module' });
