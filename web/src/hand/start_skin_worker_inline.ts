// The same for a page in one file: vite.one_file.config.ts takes this instead of start_skin_worker.ts.
import SkinWorker from './skin_worker?worker&inline';

export const startSkinWorker = (): Worker => new SkinWorker();
