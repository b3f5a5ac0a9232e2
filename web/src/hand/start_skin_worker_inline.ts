// The version for a page in one file: vite.one_file.config.ts uses it instead of start_skin_worker.ts.
import SkinWorker from './skin_worker?worker&inline';

export const startSkinWorker = (): Worker => new SkinWorker();
